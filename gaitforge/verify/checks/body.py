"""How the trunk was held: tilt, height, and whether it fell."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from gaitforge.robot.rotation import matrices
from gaitforge.verify.checks.base import Finding, Segment, SegmentCheck

Array = NDArray[np.float64]


def tilt_between(measured: Array, planned: Array) -> Array:
    """(n,) angle [rad] between the world's vertical as two poses (n, 6) see it: yaw does not count."""
    up, up_planned = (matrices(poses[:, 3:])[:, 2] for poses in (measured, planned))
    return np.asarray(np.arctan2(np.linalg.norm(np.cross(up, up_planned), axis=1), (up * up_planned).sum(axis=1)))


@dataclass(frozen=True)
class Tilt(SegmentCheck):
    """Largest angle between the planned and the measured vertical in the judged cycles."""

    name: ClassVar[str] = "tilt"
    title: ClassVar[str] = "tilt against plan"

    def find(self, segment: Segment) -> Finding:
        rows = segment.judged
        tilt = tilt_between(segment.trace.base_poses[rows], segment.trace.plan.base_poses[rows])
        return Finding.at_most(float(np.degrees(tilt.max())), segment.limit.tilt_deg, "deg")


@dataclass(frozen=True)
class BodyHeight(SegmentCheck):
    """Largest difference in height of base_link in the judged cycles."""

    name: ClassVar[str] = "body_height"
    title: ClassVar[str] = "body height against plan"

    def find(self, segment: Segment) -> Finding:
        rows = segment.judged
        error = np.abs(segment.trace.base_poses[rows, 2] - segment.trace.plan.base_poses[rows, 2]).max()
        return Finding.at_most(1000.0 * float(error), segment.limit.body_height_mm, "mm")


@dataclass(frozen=True)
class Fallen(SegmentCheck):
    """Tilt against the vertical at any time of the segment; the trunk on the ground is a fall as well."""

    name: ClassVar[str] = "fallen"
    title: ClassVar[str] = "tilt of a fall, or trunk on the ground"

    def find(self, segment: Segment) -> Finding:
        poses = segment.trace.base_poses[segment.rows]
        tilt = float(np.degrees(tilt_between(poses, np.zeros_like(poses)).max()))
        limit = segment.limits.fallen_deg
        start, end = segment.entry.start, segment.entry.end
        down = any(e.kind == "trunk" and e.time <= end and e.end >= start for e in segment.trace.unplanned)
        return Finding(tilt, limit, "deg", passed=tilt <= limit and not down)
