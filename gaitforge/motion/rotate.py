"""The same gait begun some columns later: so that a transition may leave or enter it there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.plan import MotionPlan, carry
from gaitforge.motion.timeline import place
from gaitforge.motion.trajectory import planar_motion

Array = NDArray[np.float64]


def rotated(gait: MotionPlan, columns: int) -> MotionPlan:
    """The gait with column `columns` first, in the frame of the commanded body at that moment.

    Nothing of the motion changes but where its cycle is said to begin; ValueError for what is no gait.
    """
    if gait.kind != "gait":
        raise ValueError(f"only a gait goes on for ever: {gait.name} is a {gait.kind}")
    samples = len(gait.times) - 1
    first = (columns % gait.pattern.columns) * gait.samples_per_column
    order = np.append(np.arange(first, samples), np.arange(first + 1))
    again = order < first
    again[-1] = True
    moved = planar_motion(gait.command, gait.times[first])
    cycle = planar_motion(gait.command, gait.duration)
    return replace(
        gait,
        pattern=gait.pattern.rotated(columns),
        joint_positions=gait.joint_positions[:, order],
        base_poses=_begun_at(_carried(gait.base_poses[order], cycle, again), moved),
        com=_points(gait.com[order], cycle, again, moved),
        feet=_points(gait.feet[order], cycle, again, moved),
        weights=gait.weights[order],
    )


def _carried(poses: Array, cycle: Array, again: NDArray[np.bool_]) -> Array:
    """Poses (n, 6), those of the second time round moved on by a cycle's travel."""
    out = poses.copy()
    start, end = np.zeros(6), np.array([cycle[0], cycle[1], 0.0, 0.0, 0.0, cycle[2]])
    out[again] = carry(poses[again], start, end, 1)
    return out


def _begun_at(poses: Array, moved: Array) -> Array:
    """Poses (n, 6) seen from the frame that `moved` (x, y, yaw) leads to."""
    c, s = np.cos(moved[2]), np.sin(moved[2])
    return place(poses, np.array([-c * moved[0] - s * moved[1], s * moved[0] - c * moved[1], -moved[2]]))


def _points(points: Array, cycle: Array, again: NDArray[np.bool_], moved: Array) -> Array:
    """(n, …, 3) the same for points."""
    flat = points.reshape(len(points), -1, 3)
    out = np.empty_like(flat)
    for column in range(flat.shape[1]):
        poses = np.zeros((len(points), 6))
        poses[:, :3] = flat[:, column]
        out[:, column] = _begun_at(_carried(poses, cycle, again), moved)[:, :3]
    return out.reshape(points.shape)
