"""What a log holds, topic by topic; each module gives the channels of one concern.

A channel is a topic, a schema and messages with their stamps, made from a `Run`; the writer
merges all channels by time.  A new topic is one function ``(run: Run) -> list[Channel]`` and one
line in `CHANNELS`.
"""

from __future__ import annotations

from collections.abc import Callable

from gaitforge.record.channels.camera import camera_channels
from gaitforge.record.channels.channel import Channel
from gaitforge.record.channels.description import description_channels
from gaitforge.record.channels.drawings import drawing_channels
from gaitforge.record.channels.events import event_channels
from gaitforge.record.channels.footfall import footfall_channels
from gaitforge.record.channels.joints import joint_channels
from gaitforge.record.channels.loads import load_channels
from gaitforge.record.channels.matrix import matrix_channels
from gaitforge.record.channels.segments import segment_channels
from gaitforge.record.channels.states import state_channels
from gaitforge.record.channels.surroundings import surroundings_channels
from gaitforge.record.channels.transforms import base_channels, transform_channels
from gaitforge.record.run import Run

CHANNELS: tuple[Callable[[Run], list[Channel]], ...] = (
    description_channels,
    segment_channels,
    transform_channels,
    base_channels,
    joint_channels,
    footfall_channels,
    matrix_channels,
    state_channels,
    drawing_channels,
    surroundings_channels,
    load_channels,
    event_channels,
    camera_channels,
)


def channels(run: Run) -> list[Channel]:
    """Every channel of a run."""
    return [channel for make in CHANNELS for channel in make(run)]
