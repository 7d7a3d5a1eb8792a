"""The state in which a gait begins and ends a cycle; where other segments meet it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.plan import MotionPlan, Stance
from gaitforge.motion.trajectory import Boundary
from gaitforge.robot.model import RobotModel

Array = NDArray[np.float64]
TOUCHING_M = 1e-3
"""[m] a foot this low is on the ground: between columns it is there, or a whole step high"""


def gait_state(robot: RobotModel, gait: MotionPlan, yaw: float = 0.0) -> Boundary:
    """Joints, base and their velocities at the first sample of a gait, in a frame turned back by `yaw` [rad]."""
    base, velocity = gait.base_poses[0].copy(), np.array(gait.base_spline(0.0, 1))
    com = com_velocity(robot, gait, 0.0)
    turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    for vector in (base, velocity, com):
        vector[:2] = turn @ vector[:2]
    base[5] += yaw
    ground = gait.pattern.contact[:, 0] | gait.pattern.contact[:, -1]
    joints, rates = gait.joint_positions[:, 0].copy(), np.array(gait.joint_spline(0.0, 1))
    return Boundary(joints, rates, base, velocity, com, ground, stance=gait.stance)


def end_state(robot: RobotModel, plan: MotionPlan, stopped: bool = False) -> Boundary:
    """The state in which a plan ends, in the frame of its base there; `stopped`: with every velocity gone.

    Feet are on the ground that are there now, whether they lift or land.
    """
    base, origin = plan.base_poses[-1].copy(), plan.base_poses[-1]
    base[:2] = base[5] = 0.0
    end = plan.duration
    rates, velocity, com = plan.joint_spline(end, 1), plan.base_spline(end, 1), com_velocity(robot, plan, end)
    c, s = np.cos(origin[5]), np.sin(origin[5])
    for vector in (velocity, com):
        vector[:2] = c * vector[0] + s * vector[1], c * vector[1] - s * vector[0]
    share = 0.0 if stopped else 1.0
    radii = np.array([limb.foot.radius for limb in robot.limbs])
    ground = plan.feet[-1, :, 2] - radii < TOUCHING_M
    return Boundary(plan.joint_positions[:, -1].copy(), share * rates, base, share * velocity, share * com, ground)


def com_velocity(robot: RobotModel, plan: MotionPlan, t: float) -> Array:
    """(3,) velocity of the centre of mass at t, from Pinocchio's centroidal momentum of the splines [m/s]."""
    import pinocchio

    base, rate = plan.base_spline(t), plan.base_spline(t, 1)
    q = robot.configuration(base, plan.joint_spline(t))
    v = robot.velocity_vector(base, rate, plan.joint_spline(t, 1))
    data = robot.pin_data
    pinocchio.centerOfMass(robot.pin, data, q, v)
    return np.array(data.vcom[0])


def rest_state(robot: RobotModel, joints: Array, base: Array, stance: Stance | None = None) -> Boundary:
    """Standing still, in a pose that the optimiser chooses near the given one."""
    nowhere = np.zeros(len(robot.limbs), dtype=bool)
    return Boundary(joints, np.zeros(len(joints)), base, np.zeros(6), np.zeros(3), nowhere, rest=True, stance=stance)
