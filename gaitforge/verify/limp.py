"""Limbs whose motors are off: what they touch is expected, and what they stand on is no support."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.timeline import Timeline
from gaitforge.verify.trace import UnplannedContact


def limp_feet(timeline: Timeline, segment: NDArray[np.intp]) -> NDArray[np.bool_]:
    """(n, n_F) whose motors are off; `segment` (n,) index into the timeline's entries."""
    limbs = timeline.robot.limb_names
    table = np.array([[name in entry.plan.limp for name in limbs] for entry in timeline.entries])
    return np.asarray(table[segment])


def expected_of_limp(events: Iterable[UnplannedContact], timeline: Timeline) -> tuple[UnplannedContact, ...]:
    """The events, with those that a limp limb has a part in called *limp*."""
    since: dict[str, float] = {}
    for entry in timeline.entries:
        for name in entry.plan.limp:
            since.setdefault(name, entry.start)

    def limp(event: UnplannedContact) -> bool:
        return any(_part_of(name, event.what) and event.end >= start for name, start in since.items())

    return tuple(replace(event, kind="limp") if limp(event) else event for event in events)


def _part_of(limb: str, what: str) -> bool:
    return re.search(rf"(^|against ){limb}[ _]", what) is not None
