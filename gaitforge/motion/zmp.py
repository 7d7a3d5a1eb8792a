"""The zero-moment point of a plan by full inverse dynamics, beside the CoP of the inverted pendulum."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gaitforge.footfall.margin import support_margins
from gaitforge.motion.plan import MotionPlan
from gaitforge.robot.gravity import GRAVITY
from gaitforge.robot.kinematics import feet_in_world
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
    cop: Array
    """(n, 2) of the inverted pendulum, x − z ẍ / (g + z̈), as the motion problem has it [m]"""
    cop_margin: Array
    """(n,) the same distance for the CoP [m]"""


def zero_moment_point(robot: RobotModel, plan: MotionPlan, per_interval: int = 2) -> PressurePoints:
    """ZMP and CoP at `per_interval` times an interval (at their middles, away from contact changes)."""
    robot = robot.carrying(*plan.loads)
    intervals = len(plan.times) - 1
    times = (np.arange(intervals * per_interval) + 0.5) * plan.duration / (intervals * per_interval)
    joints, base = plan.joint_spline(times), plan.base_spline(times)
    zmp, com, acceleration = _dynamics(robot, plan, times, base, joints)
    cop = com[:, :2] - (com[:, 2] / (GRAVITY + acceleration[:, 2]))[:, None] * acceleration[:, :2]
    column = np.minimum((times / plan.duration * plan.pattern.columns).astype(int), plan.pattern.columns - 1)
    stance = plan.pattern.contact.T[column]
    feet = feet_in_world(robot, base, joints)[..., :2]
    margin, cop_margin = support_margins(feet, stance, np.stack([zmp, cop], axis=1)).T
    return PressurePoints(times, zmp, com, margin, cop, cop_margin)


def _dynamics(
    robot: RobotModel, plan: MotionPlan, times: Array, base: Array, joints: Array
) -> tuple[Array, Array, Array]:
    """(n, 2) ZMP, (n, 3) centre of mass [m] and (n, 3) its acceleration [m/s²]."""
    import pinocchio

    q, v, a = _states(robot, plan, times, base, joints)
    data = robot.pin_data
    zmp, com, acceleration = (np.zeros((len(times), size)) for size in (2, 3, 3))
    for k in range(len(times)):
        wrench = pinocchio.Force(pinocchio.rnea(robot.pin, data, q[k], v[k], a[k])[:6])
        world = data.liMi[1].act(wrench)  # the base in the world; `rnea` does not fill `oMi`
        zmp[k] = -world.angular[1] / world.linear[2], world.angular[0] / world.linear[2]
        com[k] = pinocchio.centerOfMass(robot.pin, data, q[k], v[k], a[k])
        acceleration[k] = data.acom[0]
    return zmp, com, acceleration


def _states(
    robot: RobotModel, plan: MotionPlan, times: Array, base: Array, joints: Array, h: float = 1e-5
) -> tuple[Array, Array, Array]:
    """Pinocchio's q (n, nq), v and a (n, nv) along the splines; the base's a by central differences of its v."""
    rate, rates, accelerations = plan.base_spline(times, 1), plan.joint_spline(times, 1), plan.joint_spline(times, 2)
    a = robot.velocity_vector(base, rate, accelerations)
    before, after = (
        robot.velocity_vector(plan.base_spline(times + s * h), plan.base_spline(times + s * h, 1), rates)
        for s in (-1, 1)
    )
    a[:, :6] = (after - before)[:, :6] / (2 * h)
    return robot.configuration(base, joints), robot.velocity_vector(base, rate, rates), a
