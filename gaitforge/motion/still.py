"""Steps of a robot that stands: it could stop at any moment, and stay."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from gaitforge.footfall.margin import support_margins
from gaitforge.motion.constraints.balance import Balance
from gaitforge.motion.costs.smoothness import Smoothness
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.trajectory import Trajectory
from gaitforge.robot.kinematics import feet_in_world
from gaitforge.robot.model import RobotModel

Array = NDArray[np.float64]
CALM = 20.0
"""per (m/s²)² s: what an acceleration of the base costs, times that of a gait"""
CREEP_M = 1e-3
"""[m] that splines may drag feet in one stance between samples: more sets many legs against each other until motors
give way, and feet slip ten times as far"""


@dataclass(frozen=True)
class StillBalance(Balance):
    """x = Σ w e: the centre of mass itself is where `Balance` has the centre of pressure.

    By its acceleration a body can keep the CoP inside feet beside which it would tip if it stood; between steps that
    swings it to and fro.
    """

    enforced: ClassVar[str] = "at samples, for the feet of the interval before and of the one after, at rest"

    @staticmethod
    def _parameters(trajectory: Trajectory) -> Array:
        """(K, 9) as those of `Balance`, without what accelerates."""
        parameters = Balance._parameters(trajectory)
        parameters[:, :6] = 0.0
        return parameters


def stepping(options: MotionOptions) -> MotionOptions:
    """The options for steps taken from a stand, one by one."""
    still = options.changed(Balance, lambda family: StillBalance())
    return calm(still)


def calm(options: MotionOptions) -> MotionOptions:
    """The options with dear accelerations of the base."""
    return options.changed(Smoothness, lambda family: replace(family, position=CALM * family.position))


def quiet(options: MotionOptions) -> MotionOptions:
    """The options for steps of many limbs, strained by those that are missing: calm, and feet stay where they are."""
    return replace(calm(options), slip_tolerance=min(options.slip_tolerance, CREEP_M))


def static_margin(robot: RobotModel, plan: MotionPlan, per_interval: int = 2) -> float:
    """[m] that the centre of mass stays inside the polygon of the planned feet, at `per_interval` times an interval."""
    robot = robot.carrying(*plan.loads)
    count = (len(plan.times) - 1) * per_interval
    times = (np.arange(count) + 0.5) * plan.duration / count
    joints, base = plan.joint_spline(times), plan.base_spline(times)
    column = np.minimum((times / plan.duration * plan.pattern.columns).astype(int), plan.pattern.columns - 1)
    com = robot.center_of_mass(base, joints)[:, None, :2]
    feet = feet_in_world(robot, base, joints)[..., :2]
    return float(support_margins(feet - com, plan.pattern.contact.T[column], np.zeros((1, 2))).min())
