"""Is the camera on its target, and does it see it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gaitforge.verify.checks.base import Finding, Rows, Segment, SegmentCheck
from gaitforge.verify.pointing import aim_rows


def aimed_rows(segment: Segment, tool: str) -> Rows:
    """Rows of the whole segment, its first cycle too, during which the tool has a target."""
    times = segment.trace.times[segment.rows]
    on = np.zeros(len(times), dtype=bool)
    for aim in segment.timeline.aims:
        if aim.tool == tool:
            on |= aim_rows(times, aim.start, aim.end)
    return segment.rows[on]


@dataclass(frozen=True)
class CameraPointing(SegmentCheck):
    """Largest angle between optical axis and target, from the moment that the plan is on it.

    Aimed from the measured pose of the body (`Trace.aim_feedback_hz`) a camera is to be nearer to it than open loop.
    """

    name: ClassVar[str] = "camera_pointing"
    title: ClassVar[str] = "camera off its target"

    def find(self, segment: Segment) -> Finding | None:
        angles = [a[aimed_rows(segment, tool)] for tool, a in segment.trace.pointing.items()]
        found = np.concatenate([*angles, np.zeros(0)])
        if not len(found):
            return None
        closed = segment.trace.aim_feedback_hz > 0.0
        limit = segment.limit.closed_pointing_deg if closed else segment.limit.camera_pointing_deg
        return Finding.at_most(float(np.degrees(found.max())), limit, "deg")


@dataclass(frozen=True)
class LineOfSight(SegmentCheck):
    """Share of the aimed time during which something stands between camera and target."""

    name: ClassVar[str] = "line_of_sight"
    title: ClassVar[str] = "line of sight blocked"

    def find(self, segment: Segment) -> Finding | None:
        free = [s[aimed_rows(segment, tool)] for tool, s in segment.trace.sight.items()]
        found = np.concatenate([*free, np.ones(0, dtype=bool)])
        if not len(found):
            return None
        judged = segment.limit.camera_pointing_deg is not None
        return Finding.at_most(100.0 * float((~found).mean()), 0.0 if judged else None, "%")
