"""Quasi-static joint torques of a plan: what its motors have to hold, known before the robot is switched on."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.constraints.effort import quasi_static_torques
from gaitforge.motion.plan import MotionPlan
from gaitforge.robot.gravity import GRAVITY
from gaitforge.robot.kinematics import evaluate_alike, limb_parameters
from gaitforge.robot.model import RobotModel

Array = NDArray[np.float64]


def joint_torques(robot: RobotModel, plan: MotionPlan) -> Array:
    """(N + 1, 2, n_J) [N m] at the samples, with the contacts of the interval before and of the one after.

    τ = g(q) − Jᵀ f with f = (0, 0, m g w) below every foot in stance, w the plan's weights: what friction
    lets feet do to each other, and accelerations, are left out.  Tool joints are not loaded (NaN).
    """
    robot = robot.carrying(*plan.loads)
    torques = np.full((len(plan.times), 2, len(robot.joint_names)), np.nan)
    for members, rows, poses in evaluate_alike(robot, plan.joint_positions.T):
        limbs = [robot.limbs[i] for i in members]
        geometry, radius = (
            np.array([limb_parameters(robot, x) for x in limbs]),
            np.array([x.foot.radius for x in limbs]),
        )
        for side in (0, 1):
            force = robot.mass * GRAVITY * plan.weights[:, side, members].T
            found = quasi_static_torques(poses, geometry, plan.base_poses[:, 3:6], radius, force)
            torques[:, side, rows] = found.transpose(1, 0, 2)
    return torques


def effort_ratios(robot: RobotModel, plan: MotionPlan) -> dict[str, float]:
    """Limb → largest |τ| over its limit, among its joints and all samples."""
    torques = np.abs(joint_torques(robot, plan))
    return {
        limb.name: float((torques[:, :, rows] / robot.effort[rows]).max())
        for limb in robot.limbs
        for rows in [robot.joint_indices(limb)]
    }
