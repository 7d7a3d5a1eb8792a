"""What it took: joint tracking, effort, speed, energy. Reported, not judged."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gaitforge.robot.gravity import GRAVITY
from gaitforge.verify.checks.base import Finding, Segment, SegmentCheck


@dataclass(frozen=True)
class JointTracking(SegmentCheck):
    """Root mean square of the joint errors over all joints and judged times."""

    name: ClassVar[str] = "joint_tracking"
    title: ClassVar[str] = "joint error (rms)"

    def find(self, segment: Segment) -> Finding:
        rows, trace = segment.judged, segment.trace
        error = trace.joint_positions[rows] - trace.plan.joint_positions[rows]
        return Finding(float(np.degrees(np.sqrt(np.mean(error**2)))), None, "deg")


@dataclass(frozen=True)
class PeakEffort(SegmentCheck):
    """Largest torque of a joint over its limit, averaged over `effort_window_s`; 1: a joint gave all it had."""

    name: ClassVar[str] = "effort_ratio"
    title: ClassVar[str] = "peak effort over limit"

    def find(self, segment: Segment) -> Finding:
        torque = segment.trace.joint_torques[segment.judged]
        window = min(max(round(segment.limits.effort_window_s / segment.dt), 1), len(torque))
        mean = np.lib.stride_tricks.sliding_window_view(torque, window, axis=0).mean(axis=-1)
        return Finding(float((np.abs(mean) / segment.robot.effort).max()), None, "1")


@dataclass(frozen=True)
class PeakSpeed(SegmentCheck):
    """Largest speed of a joint over its limit."""

    name: ClassVar[str] = "speed_ratio"
    title: ClassVar[str] = "peak joint speed over limit"

    def find(self, segment: Segment) -> Finding:
        ratio = np.abs(segment.trace.joint_velocities[segment.judged]) / segment.robot.velocity
        return Finding(float(ratio.max()), None, "1")


@dataclass(frozen=True)
class CostOfTransport(SegmentCheck):
    """Σ |τ q̇| dt / (m g d), d the distance between the ends of the judged cycles; none below 1 cm."""

    name: ClassVar[str] = "cost_of_transport"
    title: ClassVar[str] = "mechanical cost of transport"

    def find(self, segment: Segment) -> Finding | None:
        rows, trace = segment.judged, segment.trace
        path = trace.base_poses[rows[[0, -1]], :2]
        distance = float(np.linalg.norm(path[1] - path[0]))
        if distance < 0.01:
            return None
        work = float(np.abs(trace.joint_torques[rows] * trace.joint_velocities[rows]).sum()) * segment.dt
        return Finding(work / (segment.robot.mass * GRAVITY * distance), None, "1")
