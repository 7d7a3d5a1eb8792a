"""Segments put one after the other: the motion that a robot executes, and what is expected of it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline

from gaitforge.motion.plan import MotionPlan, carry
from gaitforge.robot.model import RobotModel

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Entry:
    """One segment on the timeline, repeated `cycles` times from `start` on."""

    plan: MotionPlan
    cycles: int
    start: float
    """[s]"""
    origin: Array
    """(3,) x, y [m] and yaw [rad] of the segment's frame in the world"""

    @property
    def end(self) -> float:
        """[s]"""
        return self.start + self.cycles * self.plan.duration


@dataclass(frozen=True, eq=False)
class TimelineSamples:
    """The planned motion at n given times."""

    times: Array
    """(n,) [s]"""
    joint_positions: Array
    """(n, n_J) [rad]; tool limbs aimed at their target"""
    joint_velocities: Array
    """(n, n_J) [rad/s]"""
    base_poses: Array
    """(n, 6) planned pose of base_link in the world"""
    contact: NDArray[np.bool_]
    """(n, n_F) planned contact"""
    segment: NDArray[np.intp]
    """(n,) index into `Timeline.entries`"""
    cycle: NDArray[np.intp]
    """(n,) which repetition of the segment"""
    column: NDArray[np.intp]
    """(n,) column of the segment's pattern"""
    efforts: Array
    """(n, n_J) effort [N m] that each joint may use: its own limit, less when it squeezes, 0 when limp"""
    loads: dict[str, Array] = field(default_factory=dict)
    """name of an object → (n, 6) planned pose of its centre in base_link, NaN while it is not in reach"""


@dataclass(frozen=True, eq=False)
class Aim:
    """A tool limb that looks at a fixed point during part of the timeline."""

    limb: str
    tool: str
    target: Array
    """(3,) [m] world"""
    start: float
    """[s] from here on the tool is planned to be on its target (before it, it is moved there)"""
    end: float
    """[s]"""


@dataclass(frozen=True, eq=False)
class Timeline:
    """Everything that is executed: entries without gaps, aims of tool limbs, and the joint overrides they cause."""

    robot: RobotModel
    entries: tuple[Entry, ...]
    aims: tuple[Aim, ...] = ()
    overrides: tuple[tuple[int, CubicSpline, float, float], ...] = field(default=(), repr=False)
    """(joint row, spline, start, end) …: rows recomputed along the timeline for tool limbs"""

    @property
    def duration(self) -> float:
        """[s]"""
        return self.entries[-1].end

    def sample(self, times: ArrayLike) -> TimelineSamples:
        """The planned motion at `times` [s] (n,), each within [0, duration]."""
        t = np.atleast_1d(np.asarray(times, dtype=float))
        n, n_j, n_f = len(t), len(self.robot.joint_names), len(self.robot.limbs)
        starts = np.array([e.start for e in self.entries])
        segment = np.clip(np.searchsorted(starts, t + 1e-9, side="right") - 1, 0, len(starts) - 1)
        q, dq, base = np.zeros((n, n_j)), np.zeros((n, n_j)), np.zeros((n, 6))
        contact = np.zeros((n, n_f), dtype=bool)
        cycle, column = np.zeros(n, dtype=np.intp), np.zeros(n, dtype=np.intp)
        for index, entry in enumerate(self.entries):
            here = np.flatnonzero(segment == index)
            if not len(here):
                continue
            plan, local = entry.plan, t[here] - entry.start
            turn = np.clip(np.floor((local + 1e-9) / plan.duration).astype(np.intp), 0, entry.cycles - 1)
            phase = np.clip(local - turn * plan.duration, 0.0, plan.duration)
            q[here], dq[here] = plan.joint_spline(phase), plan.joint_spline(phase, 1)
            pose = plan.base_spline(phase)
            for k in np.unique(turn):
                rows = turn == k
                pose[rows] = carry(pose[rows], plan.base_poses[0], plan.base_poses[-1], int(k))
            base[here] = place(pose, entry.origin)
            m = plan.pattern.columns
            column[here] = np.clip(np.floor((phase + 1e-9) / plan.duration * m).astype(np.intp), 0, m - 1)
            contact[here] = plan.pattern.contact[:, column[here]].T
            cycle[here] = turn
        for row, spline, start, end in self.overrides:
            inside = (t >= start) & (t <= end)
            q[inside, row], dq[inside, row] = spline(t[inside]), spline(t[inside], 1)
        efforts, loads = self._grasps(t, segment, cycle)
        return TimelineSamples(t, q, dq, base, contact, segment, cycle, column, efforts, loads)

    def _grasps(self, t: Array, segment: NDArray[np.intp], cycle: NDArray[np.intp]) -> tuple[Array, dict[str, Array]]:
        efforts = np.tile(self.robot.effort, (len(t), 1))
        loads: dict[str, Array] = {}
        for index, entry in enumerate(self.entries):
            here = np.flatnonzero(segment == index)
            phase = np.clip(t[here] - entry.start - cycle[here] * entry.plan.duration, 0.0, entry.plan.duration)
            for limb in map(self.robot.limb, entry.plan.limp):
                for joint in (*limb.joints, *limb.tool_joints):
                    efforts[here, self.robot.joint_names.index(joint)] = 0.0
            for holding in entry.plan.holdings:
                poses = loads.setdefault(holding.object, np.full((len(t), 6), np.nan))
                poses[here] = holding.at(phase / entry.plan.duration)
                for joint, effort in holding.efforts.items():
                    row = self.robot.joint_names.index(joint)
                    efforts[here, row] = np.minimum(efforts[here, row], effort)
        return efforts, loads


def place(poses: Array, origin: Array) -> Array:
    """Poses (n, 6) of a segment's frame in the world; `origin` is x, y, yaw of that frame."""
    c, s = np.cos(origin[2]), np.sin(origin[2])
    placed = np.array(poses, dtype=float)
    placed[:, 0] = origin[0] + c * poses[:, 0] - s * poses[:, 1]
    placed[:, 1] = origin[1] + s * poses[:, 0] + c * poses[:, 1]
    placed[:, 5] += origin[2]
    return placed
