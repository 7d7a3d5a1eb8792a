"""Numbers derived from a trace that both logs and plots show."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.timeline import Timeline
from gaitforge.record.tree import rotate
from gaitforge.robot.rotation import quaternions
from gaitforge.verify.trace import Trace

Array = NDArray[np.float64]


def travel_direction(timeline: Timeline, trace: Trace) -> Array:
    """(n, 2) unit vectors, world: where the body is commanded to go; ahead when no speed is commanded."""
    heading = np.array([e.plan.command.heading for e in timeline.entries])[trace.plan.segment]
    angle = trace.plan.base_poses[:, 5] + heading
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


def forward_speed(poses: Array, direction: Array, times: Array, window: float | Array) -> Array:
    """(n,) mean speed [m/s] along `direction` over a window [s] (one, or one a row) centred at each time.

    The window is cut where the run begins and ends.
    """
    step = np.diff(poses[:, :2], axis=0) * 0.5 * (direction[1:] + direction[:-1])
    travelled = np.concatenate([[0.0], np.cumsum(step.sum(axis=1))])
    half = 0.5 * np.broadcast_to(np.asarray(window, dtype=float), times.shape)
    start, end = np.maximum(times - half, times[0]), np.minimum(times + half, times[-1])
    distance = np.interp(end, times, travelled) - np.interp(start, times, travelled)
    return np.asarray(distance / np.maximum(end - start, 1e-9))


def column_seconds(timeline: Timeline, trace: Trace) -> Array:
    """(n,) [s] duration of the column that each row is in."""
    seconds = np.array([e.plan.duration / e.plan.pattern.columns for e in timeline.entries])
    return np.asarray(seconds[trace.plan.segment])


def cycle_seconds(timeline: Timeline, trace: Trace) -> Array:
    """(n,) [s] duration of one repetition of the segment that each row is in."""
    seconds = np.array([e.plan.duration for e in timeline.entries])
    return np.asarray(seconds[trace.plan.segment])


def tilt(poses: Array) -> Array:
    """(n,) [rad] angle between the body's z axis and the vertical."""
    up = rotate(quaternions(poses[:, 3:]), np.array([0.0, 0.0, 1.0]))
    return np.asarray(np.arccos(np.clip(up[:, 2], -1.0, 1.0)))


def center_of_pressure(trace: Trace) -> Array:
    """(n, 2) [m] world: contact points weighted by normal force; NaN when nothing presses."""
    force = trace.normal_force[..., None]
    total = force.sum(axis=1)
    weighted = (force * trace.contact_points[..., :2]).sum(axis=1)
    return np.asarray(np.divide(weighted, total, out=np.full_like(weighted, np.nan), where=total > 0))
