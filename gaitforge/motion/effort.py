"""Quasi-static joint torques of a plan: what its motors have to hold, known before the robot is switched on."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.constraints.balance import GRAVITY
from gaitforge.motion.constraints.effort import quasi_static_torques
from gaitforge.motion.plan import MotionPlan
from gaitforge.robot.kinematics import limb_parameters
from gaitforge.robot.model import RobotModel

Array = NDArray[np.float64]


def joint_torques(robot: RobotModel, plan: MotionPlan) -> Array:
    """(N + 1, 2, n_J) [N m] at the samples, with the contacts of the interval before and of the one after.

    τ = g(q) − Jᵀ f with f = (0, 0, m g w) below every foot in stance, w the plan's weights: what friction
    lets feet do to each other, and accelerations, are left out.  Tool joints are not loaded (NaN).
    """
    robot = robot.carrying(*plan.loads)
    samples = len(plan.times)
    torques = np.full((samples, 2, len(robot.joint_names)), np.nan)
    for i, limb in enumerate(robot.limbs):
        rows = robot.joint_indices(limb)
        joints = np.repeat(plan.joint_positions[rows].T, 2, axis=0)
        rpy = np.repeat(plan.base_poses[:, 3:6], 2, axis=0)
        force = robot.mass * GRAVITY * plan.weights[:, :, i].ravel()
        found = quasi_static_torques(joints, limb_parameters(robot, limb), rpy, limb.foot.radius, force)
        torques[:, :, rows] = found.reshape(samples, 2, len(rows))
    return torques


def effort_ratios(robot: RobotModel, plan: MotionPlan) -> dict[str, float]:
    """Limb → largest |τ| over its limit, among its joints and all samples."""
    torques = np.abs(joint_torques(robot, plan))
    return {
        limb.name: float((torques[:, :, rows] / robot.effort[rows]).max())
        for limb in robot.limbs
        for rows in [robot.joint_indices(limb)]
    }
