"""The zero-moment point of a plan by full inverse dynamics, beside the CoP of the inverted pendulum."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gaitforge.footfall.margin import support_margins
from gaitforge.motion.plan import MotionPlan
from gaitforge.robot.model import RobotModel

Array = NDArray[np.float64]


class PressurePoints(NamedTuple):
    """Where the ground force acts, by two models."""

    times: Array
    """(n,) [s]"""
    zmp: Array
    """(n, 2) by recursive Newton–Euler over all bodies [m]"""
    com: Array
    """(n, 3) centre of mass [m]"""
    margin: Array
    """(n,) signed distance of the ZMP inside the support polygon of the planned feet [m]; < 0 outside"""


def zero_moment_point(robot: RobotModel, plan: MotionPlan, per_interval: int = 4) -> PressurePoints:
    """ZMP at `per_interval` times an interval (at their middles, away from contact changes)."""
    import pinocchio

    robot = robot.carrying(*plan.loads)
    intervals = len(plan.times) - 1
    times = (np.arange(intervals * per_interval) + 0.5) * plan.duration / (intervals * per_interval)
    q, dq, ddq = (plan.joint_spline(times, k) for k in range(3))
    base, rate = plan.base_spline(times), plan.base_spline(times, 1)
    data, h = robot.pin.createData(), 1e-5
    zmp, com, margin = np.zeros((len(times), 2)), np.zeros((len(times), 3)), np.zeros(len(times))
    before, after = (plan.base_spline(times + s * h) for s in (-1, 1))
    rate_before, rate_after = (plan.base_spline(times + s * h, 1) for s in (-1, 1))
    for k in range(len(times)):
        configuration = robot.configuration(base[k], q[k])
        velocity = robot.velocity_vector(base[k], rate[k], dq[k])
        change = robot.velocity_vector(after[k], rate_after[k], ddq[k]) - robot.velocity_vector(
            before[k], rate_before[k], ddq[k]
        )
        acceleration = robot.velocity_vector(base[k], rate[k], ddq[k])
        acceleration[:6] = change[:6] / (2 * h)
        wrench = pinocchio.Force(pinocchio.rnea(robot.pin, data, configuration, velocity, acceleration)[:6])
        world = data.liMi[1].act(wrench)  # the base in the world; `rnea` does not fill `oMi`
        zmp[k] = -world.angular[1] / world.linear[2], world.angular[0] / world.linear[2]
        com[k] = pinocchio.centerOfMass(robot.pin, data, configuration)
        column = min(int(times[k] / plan.duration * plan.pattern.columns), plan.pattern.columns - 1)
        stance = plan.pattern.contact[:, column]
        feet = robot.foot_positions(base[k], q[k])[:, :2]
        margin[k] = support_margins(feet[None], stance[None], zmp[k][None])[0, 0]
    return PressurePoints(times, zmp, com, margin)
