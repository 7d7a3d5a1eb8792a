"""Did it get where the plan says: speed, heading, drift."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from gaitforge.verify.checks.base import Finding, Segment, SegmentCheck

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Travel:
    """Mean displacement per judged cycle (a transition or stand is one cycle)."""

    planned_m: float
    """Distance between the ends of a cycle"""
    ahead_m: float
    """Measured displacement along the planned direction of travel"""
    aside_m: float
    """… across it, to the left"""
    cycles: int
    duration: float
    """[s] of one cycle"""

    @property
    def speed(self) -> float:
        """Measured mean speed along the planned direction of travel [m/s]."""
        return self.ahead_m / self.duration


def travel(segment: Segment) -> Travel:
    """Planned and measured displacement, each in the frame of its own yaw at the start of the cycle.

    So a segment answers for its own error and not for the heading that it was handed; a segment
    planned to stay where it is has no direction, and is measured by how far it went.
    """
    cycles = segment.cycles
    planned = _displacement(segment.trace.plan.base_poses, cycles)
    measured = _displacement(segment.trace.base_poses, cycles)
    distance = float(np.linalg.norm(planned, axis=1).mean())
    duration = segment.entry.plan.duration
    if distance < 1e-6:
        return Travel(distance, float(np.linalg.norm(measured.mean(axis=0))), 0.0, len(cycles), duration)
    ahead = planned / np.linalg.norm(planned, axis=1)[:, None]
    left = np.stack([-ahead[:, 1], ahead[:, 0]], axis=1)
    along, across = (measured * ahead).sum(axis=1), (measured * left).sum(axis=1)
    return Travel(distance, float(along.mean()), float(across.mean()), len(cycles), duration)


def _displacement(poses: Array, cycles: NDArray[np.intp]) -> Array:
    """(k, 2) from the first to the last row of each cycle, in the yaw frame of the first."""
    first, last = poses[cycles[:, 0]], poses[cycles[:, 1]]
    step, c, s = last[:, :2] - first[:, :2], np.cos(first[:, 5]), np.sin(first[:, 5])
    return np.stack([c * step[:, 0] + s * step[:, 1], c * step[:, 1] - s * step[:, 0]], axis=1)


@dataclass(frozen=True)
class Speed(SegmentCheck):
    """Mean speed against plan: a gait may be slower or faster by the limit, the others only not slower."""

    name: ClassVar[str] = "speed"
    title: ClassVar[str] = "mean speed against plan"

    def find(self, segment: Segment) -> Finding:
        moved = travel(segment)
        missing = moved.planned_m - moved.ahead_m
        if segment.entry.plan.kind == "gait" or moved.planned_m < 1e-6:
            missing = abs(missing)
        floor = segment.limits.distance_floor_mm / 1000.0
        share = segment.limit.speed_percent / 100.0
        if share * moved.planned_m < floor:  # a percentage of next to nothing says nothing
            return Finding.at_most(max(1000.0 * missing, 0.0), 1000.0 * floor, "mm")
        return Finding.at_most(max(100.0 * missing / moved.planned_m, 0.0), 100.0 * share, "%")


@dataclass(frozen=True)
class Heading(SegmentCheck):
    """Change of yaw against plan; of gaits per metre of travel, from `heading_from_m` on."""

    name: ClassVar[str] = "heading"
    title: ClassVar[str] = "heading against plan"

    def find(self, segment: Segment) -> Finding:
        first, last = segment.cycles[0, 0], segment.cycles[-1, 1]
        measured, planned = segment.trace.base_poses[:, 5], segment.trace.plan.base_poses[:, 5]
        error = abs(float(np.degrees((measured[last] - measured[first]) - (planned[last] - planned[first]))))
        if segment.entry.plan.kind != "gait":
            return Finding.at_most(error, segment.limit.heading_deg, "deg")
        moved = travel(segment)
        length = moved.planned_m * moved.cycles
        if length < segment.limits.heading_from_m:
            return Finding(error, None, "deg")
        return Finding.at_most(error / length, segment.limit.heading_deg, "deg/m")


@dataclass(frozen=True)
class LateralDrift(SegmentCheck):
    """Displacement across the planned direction of travel over the judged cycles."""

    name: ClassVar[str] = "lateral_drift"
    title: ClassVar[str] = "drift across the direction of travel"

    def find(self, segment: Segment) -> Finding:
        moved = travel(segment)
        return Finding(1000.0 * abs(moved.aside_m) * moved.cycles, None, "mm")
