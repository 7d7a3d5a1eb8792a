"""The state in which a gait begins and ends a cycle; where other segments meet it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.plan import MotionPlan, Stance
from gaitforge.motion.trajectory import Boundary
from gaitforge.robot.model import RobotModel

Array = NDArray[np.float64]


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
