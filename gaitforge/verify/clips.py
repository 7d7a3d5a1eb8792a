"""A clip of a simulated run: frames drawn from its trace, as an animated WebP that any browser plays."""

from __future__ import annotations

import io
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from gaitforge.robot.model import RobotModel
from gaitforge.task.scene import Scene
from gaitforge.verify.pictures import Poses, View, frames, view_of

QUALITY = 60
"""[%] of WebP's scale."""


def render_clip(
    robot: RobotModel,
    trace: Poses,
    scene: Scene,
    *,
    start: float = 0.0,
    end: float | None = None,
    frames_hz: float = 10.0,
    size: tuple[int, int] = (480, 270),
    view: View | None = None,
) -> bytes:
    """Animated WebP of the run from `start` to `end` [s] (None: to its end), as fast as it went, in a loop.

    size: width, height [pixel]; view: None is `view_of` the scene.  Raises ValueError when there is
    nothing to show or `frames_hz` is not positive.
    """
    last = float(trace.times[-1]) if end is None else min(end, float(trace.times[-1]))
    if not frames_hz > 0.0 or not start < last:
        raise ValueError(f"a clip of {frames_hz} frames a second from {start} to {last} s shows nothing")
    times = np.arange(start, last, 1.0 / frames_hz).tolist()
    return webp(frames(robot, trace, scene, times, size, view or view_of(scene)), frames_hz)


def webp(drawn: Iterable[NDArray[np.uint8]], frames_hz: float) -> bytes:
    """Pictures (height, width, 3) one after the other, in a loop, as an animated WebP."""
    from PIL import Image

    images = [Image.fromarray(np.ascontiguousarray(pixels)) for pixels in drawn]
    out = io.BytesIO()
    pause = round(1000.0 / frames_hz)  # [ms]
    images[0].save(
        out, format="WEBP", save_all=True, append_images=images[1:], duration=pause, loop=0, quality=QUALITY, method=2
    )
    return out.getvalue()
