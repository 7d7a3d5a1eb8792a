"""Is the load where it was planned to be, relative to the body."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gaitforge.verify.checks.base import Finding, Segment, SegmentCheck
from gaitforge.verify.grasps import load_errors


def worst_errors(segment: Segment) -> tuple[float, float] | None:
    """Largest distance [m] and angle [rad] of any load in the whole segment; None when it has none."""
    trace, rows = segment.trace, segment.rows
    found = [
        load_errors(trace.base_poses[rows], trace.objects[h.object][rows], trace.plan.loads[h.object][rows])
        for h in segment.entry.plan.holdings
    ]
    if not found:
        return None
    far, turned = (np.concatenate(values) for values in zip(*found, strict=True))
    return float(np.nanmax(far)), float(np.nanmax(turned))


@dataclass(frozen=True)
class LoadPlace(SegmentCheck):
    """Largest distance of a load from its planned place relative to the body: before, in and after the grasp."""

    name: ClassVar[str] = "load_place"
    title: ClassVar[str] = "load off its place"

    def find(self, segment: Segment) -> Finding | None:
        worst = worst_errors(segment)
        return None if worst is None else Finding.at_most(1000.0 * worst[0], segment.limit.load_place_mm, "mm")


@dataclass(frozen=True)
class LoadAngle(SegmentCheck):
    """Largest angle between a load and its planned orientation relative to the body."""

    name: ClassVar[str] = "load_angle"
    title: ClassVar[str] = "load turned in the grasp"

    def find(self, segment: Segment) -> Finding | None:
        worst = worst_errors(segment)
        if worst is None:
            return None
        return Finding.at_most(float(np.degrees(worst[1])), segment.limit.load_angle_deg, "deg")
