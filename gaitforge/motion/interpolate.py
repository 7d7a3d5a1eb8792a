"""Equation (3): the paper's baseline transition, a blend of two gaits over one cycle."""

from __future__ import annotations

import time

import numpy as np

from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion.plan import Command, MotionPlan, SolveReport
from gaitforge.motion.state import gait_state
from gaitforge.robot.model import RobotModel


def interpolate(robot: RobotModel, before: MotionPlan, after: MotionPlan, name: str) -> MotionPlan:
    """q(t) = q_a (1 − t/T) + q_b t/T; gaits of unequal cycle durations are blended by phase, T their mean.

    The base is what the same blend of both base motions says; the contact pattern is that of gait a
    in the first half and of gait b in the second.  Nothing is optimised, so nothing is promised.
    """
    begin = time.perf_counter()
    duration = 0.5 * (before.duration + after.duration)
    columns = max(before.pattern.columns, after.pattern.columns)
    intervals = columns * max(before.samples_per_column, after.samples_per_column)
    share = np.linspace(0.0, 1.0, intervals + 1)
    weight = share[:, None]
    joints = (1 - weight) * before(share * before.duration) + weight * after(share * after.duration)
    rates = [
        (1 - w) * plan_a + w * plan_b
        for w, plan_a, plan_b in (
            (0.0, _rate(before, 0.0, duration), _rate(after, 0.0, duration)),
            (1.0, _rate(before, 1.0, duration), _rate(after, 1.0, duration)),
        )
    ]
    change = (after(0.0) - before(0.0)) / duration
    base = _blended_base(before, after, share)
    feet = np.array([robot.foot_positions(b, q) for b, q in zip(base, joints, strict=True)])
    com = np.array([robot.center_of_mass(b, q) for b, q in zip(base, joints, strict=True)])
    contact = np.where(np.arange(columns) < columns / 2, _stretched(before, columns), _stretched(after, columns))
    limbs = before.pattern.limbs
    state_a, state_b = gait_state(robot, before), gait_state(robot, after)
    command = Command(0.5 * (before.command.speed + after.command.speed), before.command.heading)
    return MotionPlan(
        name=name,
        kind="transition",
        pattern=FootfallPattern(contact, limbs, cyclic=False, source="interpolated"),
        times=share * duration,
        joint_positions=joints.T.copy(),
        base_poses=base,
        com=com,
        feet=feet,
        weights=np.zeros((intervals + 1, 2, len(limbs))),
        command=command,
        roles=dict(after.roles),
        joint_velocity_ends=np.array([rates[0] + change, rates[1] + change]),
        base_velocity_ends=np.array([state_a.base_velocity, state_b.base_velocity]),
        report=SolveReport("Interpolated", 0, time.perf_counter() - begin),
    )


def _rate(plan: MotionPlan, share: float, duration: float) -> np.ndarray:
    return np.asarray(plan.joint_spline(share * plan.duration, 1)) * plan.duration / duration


def _stretched(plan: MotionPlan, columns: int) -> np.ndarray:
    """(n_F, columns) the pattern read at as many columns, by phase."""
    index = (np.arange(columns) * plan.pattern.columns) // columns
    return plan.pattern.contact[:, index]


def _blended_base(before: MotionPlan, after: MotionPlan, share: np.ndarray) -> np.ndarray:
    """(n, 6) the body moves by the blended velocities of both gaits."""
    first = before.base_spline(share * before.duration) - before.base_poses[0]
    second = after.base_spline(share * after.duration) - after.base_poses[0]
    weight = share[:, None]
    steps = (1 - weight[1:]) * np.diff(first, axis=0) + weight[1:] * np.diff(second, axis=0)
    drift = weight * (after.base_poses[0] - before.base_poses[0])
    drift[:, :2] = 0.0
    base = before.base_poses[0] + np.vstack([np.zeros(6), np.cumsum(steps, axis=0)]) + drift
    return np.asarray(base)
