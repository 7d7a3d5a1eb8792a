"""Equation (3): the paper's baseline transition, a blend of two gaits over one cycle."""

from __future__ import annotations

import time

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion.plan import Command, MotionPlan
from gaitforge.motion.report import SolveReport
from gaitforge.robot.kinematics import feet_in_world
from gaitforge.robot.model import RobotModel

Array = NDArray[np.float64]


def interpolate(robot: RobotModel, before: MotionPlan, after: MotionPlan, name: str) -> MotionPlan:
    """q(t) = q_a (1 − t/T) + q_b t/T; gaits of unequal cycle durations are blended by phase, T their mean.

    Height, roll and pitch of the base are blended in the same way, and so are its velocities ahead,
    aside and about the vertical.  The contact pattern is that of gait a in the first half and of gait
    b in the second.  Nothing is optimised, so nothing is promised.
    """
    begin = time.perf_counter()
    duration = 0.5 * (before.duration + after.duration)
    columns = max(before.pattern.columns, after.pattern.columns)
    intervals = columns * max(before.samples_per_column, after.samples_per_column)
    share = np.linspace(0.0, 1.0, intervals + 1)
    weight = share[:, None]
    joints = (1 - weight) * before(share * before.duration) + weight * after(share * after.duration)
    change = (after(0.0) - before(0.0)) / duration
    rates = [_rate(plan.joint_spline, plan, share, duration) for plan, share in ((before, 0.0), (after, 1.0))]
    base, base_rates = _blended_base(before, after, share, duration)
    contact = np.where(np.arange(columns) < columns / 2, _stretched(before, columns), _stretched(after, columns))
    limbs = before.pattern.limbs
    command = Command(0.5 * (before.command.speed + after.command.speed), before.command.heading)
    return MotionPlan(
        name=name,
        kind="transition",
        pattern=FootfallPattern(contact, limbs, cyclic=False, source="interpolated"),
        times=share * duration,
        joint_positions=joints.T.copy(),
        base_poses=base,
        com=robot.center_of_mass(base, joints),
        feet=feet_in_world(robot, base, joints),
        weights=np.zeros((intervals + 1, 2, len(limbs))),
        command=command,
        roles=dict(after.roles),
        loads=robot.loads,
        joint_velocity_ends=np.array(rates) + change,
        base_velocity_ends=base_rates,
        report=SolveReport("Interpolated", 0, time.perf_counter() - begin),
    )


def _rate(spline: CubicSpline, plan: MotionPlan, share: Array | float, duration: float) -> Array:
    """Derivative of a gait's spline at shares of its cycle, played so that a cycle takes `duration`."""
    return np.asarray(spline(share * plan.duration, 1)) * plan.duration / duration


def _stretched(plan: MotionPlan, columns: int) -> np.ndarray:
    """(n_F, columns) the pattern read at as many columns, by phase."""
    index = (np.arange(columns) * plan.pattern.columns) // columns
    return plan.pattern.contact[:, index]


def _blended_base(before: MotionPlan, after: MotionPlan, share: Array, duration: float) -> tuple[Array, Array]:
    """(n, 6) base poses and (2, 6) their velocities at both ends."""
    w, ends = share[:, None], (before.base_poses[0], after.base_poses[0])
    poses = [plan.base_spline(share * plan.duration) for plan in (before, after)]
    rates = [_rate(plan.base_spline, plan, share, duration) for plan in (before, after)]
    twists = [
        np.stack([*_turned(rate[:, :2], -pose[:, 5]), rate[:, 5]]) for pose, rate in zip(poses, rates, strict=True)
    ]
    ahead, aside, spin = (1 - share) * twists[0] + share * twists[1]
    spin = spin + (ends[1][5] - ends[0][5]) / duration
    step = duration / (len(share) - 1)
    yaw = ends[0][5] + _integral(spin, step)
    velocity = np.stack(_turned(np.stack([ahead, aside], axis=1), yaw), axis=1)
    base = np.empty((len(share), 6))
    base[:, :2] = ends[0][:2] + np.stack([_integral(v, step) for v in velocity.T], axis=1)
    base[:, 2:5] = ((1 - w) * poses[0] + w * poses[1])[:, 2:5]
    base[:, 5] = yaw
    level = np.array([rates[0][0], rates[1][-1]]) + (ends[1] - ends[0]) / duration
    level[:, :2], level[:, 5] = velocity[[0, -1]], spin[[0, -1]]
    return base, level


def _turned(vectors: Array, angle: Array) -> list[Array]:
    """x and y of (n, 2) vectors, each turned by its angle [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    return [c * vectors[:, 0] - s * vectors[:, 1], s * vectors[:, 0] + c * vectors[:, 1]]


def _integral(rate: Array, step: float) -> Array:
    """Running integral of samples by the trapezoidal rule, from 0."""
    return np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * step)])
