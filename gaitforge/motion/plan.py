"""Motion plans P: sampled configurations and the spline through them, equation (1)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline

from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion.manipulation.holding import Holding
from gaitforge.motion.report import SolveReport
from gaitforge.robot.payload import Load
from gaitforge.task.roles import Failed, Role

Array = NDArray[np.float64]
Kind = Literal["gait", "transition", "stand"]


@dataclass(frozen=True)
class Command:
    """What the body is asked to do."""

    speed: float = 0.0
    """[m/s]"""
    heading: float = 0.0
    """[rad] of the velocity in the body frame, counter-clockwise from ahead"""
    yaw_rate: float = 0.0
    """[rad/s]"""
    body_height: float | None = None
    """[m] mean height of base_link above the ground; None: where the posture stands"""
    roll: float = 0.0
    """[rad] mean"""
    pitch: float = 0.0
    """[rad] mean, nose down is positive"""
    step_height: float | None = None
    """[m] how high feet are lifted; None: the options' or the robot's"""


@dataclass(frozen=True, eq=False)
class Stance:
    """How the robot stands in the mean of a gait: what costs pull to and where the optimiser begins."""

    body: Array
    """(3,) height [m], roll, pitch [rad] of base_link"""
    joints: Array
    """(n_J,) [rad] of limbs that walk"""


@dataclass(frozen=True, eq=False)
class MotionPlan:
    """C and P of one segment (a gait, a transition or a stand), in the segment's own frame.

    The frame is the world with the origin on the ground where the commanded body is at t = 0 and
    x along its yaw then.  All arrays have one entry per sample t_0 … t_N, N = r·m; in a gait the
    last sample is the first one, carried on by the commanded travel.
    """

    name: str
    kind: Kind
    pattern: FootfallPattern
    times: Array
    """(N + 1,) [s]"""
    joint_positions: Array
    """P: (n_J, N + 1) [rad], rows `RobotModel.joint_names`"""
    base_poses: Array
    """(N + 1, 6) x, y, z [m], roll, pitch, yaw [rad]"""
    com: Array
    """(N + 1, 3) [m]"""
    feet: Array
    """(N + 1, n_F, 3) centres of the foot spheres [m]"""
    weights: Array
    """(N + 1, 2, n_F) weights of the CoP: [k, 0] over the feet of the interval before, [k, 1] after t_k"""
    command: Command
    roles: Mapping[str, Role] = field(default_factory=dict)
    """Nonlocomotive limbs and what they do."""
    loads: tuple[Load, ...] = ()
    """What the robot carries all along."""
    holdings: tuple[Holding, ...] = ()
    """Objects in the robot's grasp, or in its reach."""
    stance: Stance | None = None
    """The commanded mean stance of a gait; None: the nominal one."""
    joint_velocity_ends: Array | None = None
    """(2, n_J) clamped end velocities [rad/s]; None in a gait, whose spline is periodic"""
    base_velocity_ends: Array | None = None
    """(2, 6) the same for the base"""
    unbalanced_s: float = 0.0
    """[s] from its start in which nothing keeps the robot from tipping: a leg that bore it is gone, others land"""
    report: SolveReport = field(default_factory=SolveReport)
    relaxed: tuple[str, ...] = ()

    @property
    def limp(self) -> tuple[str, ...]:
        """Limbs whose motors are off."""
        return tuple(n for n, role in self.roles.items() if isinstance(role, Failed) and role.mode == "limp")

    @property
    def duration(self) -> float:
        """[s]"""
        return float(self.times[-1])

    @property
    def samples_per_column(self) -> int:
        """r"""
        return (len(self.times) - 1) // self.pattern.columns

    @property
    def speed(self) -> float:
        """Planned mean speed of the base over the segment [m/s]: distance between the ends over duration."""
        return float(np.linalg.norm(self.base_poses[-1, :2] - self.base_poses[0, :2])) / self.duration

    @cached_property
    def joint_spline(self) -> CubicSpline:
        """q(t), equation (1): periodic in a gait, clamped to the neighbours' velocities elsewhere."""
        if self.joint_velocity_ends is None:
            values = self.joint_positions.T.copy()
            values[-1] = values[0]
            return CubicSpline(self.times, values, axis=0, bc_type="periodic")
        ends = self.joint_velocity_ends
        return CubicSpline(self.times, self.joint_positions.T, axis=0, bc_type=((1, ends[0]), (1, ends[1])))

    @cached_property
    def base_spline(self) -> CubicSpline:
        """Base pose against time; in a turning gait the spline of one cycle is carried on by `Timeline`."""
        if self.base_velocity_ends is not None:
            ends = self.base_velocity_ends
            return CubicSpline(self.times, self.base_poses, axis=0, bc_type=((1, ends[0]), (1, ends[1])))
        return _carried_spline(self.times, self.base_poses)

    def __call__(self, t: ArrayLike) -> Array:
        """(…, n_J) joint positions at t [s]; a gait goes on periodically."""
        return np.asarray(self.joint_spline(t))


def _carried_spline(times: Array, poses: Array, turns: int = 2) -> CubicSpline:
    """One cycle of a pose that repeats after a rigid motion: spline over several carried copies."""
    duration, first, last = times[-1], poses[0], poses[-1]
    yaw = last[5] - first[5]
    copies, stamps = [], []
    for turn in range(-turns, turns + 1):
        copies.append(carry(poses[:-1], first, last, turn))
        stamps.append(times[:-1] + turn * duration)
    copies.append(carry(poses[:1], first, last, turns + 1))
    stamps.append(times[:1] + (turns + 1) * duration)
    values = np.concatenate(copies)
    if abs(yaw) < 1e-12:  # exact: a periodic spline plus a straight line
        slope = (last - first) / duration
        rest = poses - np.outer(times, slope)
        rest[-1] = rest[0]
        spline = CubicSpline(times, rest, axis=0, bc_type="periodic")
        spline.c[-2] += slope
        spline.c[-1] += np.outer(times[:-1], slope)
        spline.extrapolate = True  # not periodic any more: the end is where the travel leads
        return spline
    return CubicSpline(np.concatenate(stamps), values, axis=0)


def carry(poses: Array, first: Array, last: Array, turns: int) -> Array:
    """`poses` (n, 6) moved on by `turns` times the planar motion that takes pose `first` to `last`."""
    moved = np.array(poses, dtype=float)
    yaw = float(last[5] - first[5])
    c, s = np.cos(yaw), np.sin(yaw)
    turn = np.array([[c, -s], [s, c]])
    if turns < 0:
        turn = turn.T
    for _ in range(abs(turns)):
        if turns > 0:
            moved[:, :2] = (moved[:, :2] - first[:2]) @ turn.T + last[:2]
            moved[:, 5] += yaw
        else:
            moved[:, :2] = (moved[:, :2] - last[:2]) @ turn.T + first[:2]
            moved[:, 5] -= yaw
    return moved
