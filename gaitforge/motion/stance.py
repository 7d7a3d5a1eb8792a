"""How a robot is commanded to stand in the mean: height and tilt of its body, and the posture that goes with them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitforge.errors import InputError, Problem
from gaitforge.motion.plan import Command, Stance
from gaitforge.robot.kinematics import evaluate_limb, limb_parameters
from gaitforge.robot.limbs import Limb
from gaitforge.robot.model import RobotModel
from gaitforge.robot.rotation import matrices

Array = NDArray[np.float64]
Posture = str | Mapping[str, Sequence[float]]
"""A posture of the robot by name, or limb name → joint positions [rad] of limbs that do not stand nominally."""


def commanded_stance(robot: RobotModel, command: Command, posture: Posture | None = None) -> Stance:
    """The mean stance: the feet where `posture` (the nominal one) has them, the body at its commanded height and tilt.

    Where height, roll or pitch differ from those that the posture stands at, its joints are those that
    keep the feet in place (as near as their limits allow).  Raises `InputError` for unknown postures and
    limbs, and for postures that are not the robot's.
    """
    joints = _posture(robot, posture)
    bottoms = _bottoms(robot, joints)
    stands_at = robot.nominal.body_height if posture is None else -float(bottoms.min())
    height = stands_at if command.body_height is None else command.body_height
    stance = Stance(np.array([height, command.roll, command.pitch]), joints)
    if np.abs(stance.body - [stands_at, 0.0, 0.0]).max() < 1e-12 and np.ptp(bottoms) < 1e-9:
        return stance
    level = np.array([0.0, 0.0, stands_at, 0.0, 0.0, 0.0])
    holds = robot.foot_positions(level, joints)
    base = np.array([0.0, 0.0, *stance.body, 0.0])
    turn = matrices(base[3:6])
    kept = joints.copy()
    for limb, hold in zip(robot.limbs, holds, strict=True):
        rows = robot.joint_indices(limb)
        goal = turn.T @ (np.array([hold[0], hold[1], limb.foot.radius]) - base[:3])
        kept[rows] = reaching_joints(robot, limb, goal, joints[rows])
    return Stance(stance.body, kept)


def reaching_joints(robot: RobotModel, limb: Limb, goal: ArrayLike, near: Array, iterations: int = 60) -> Array:
    """(n,) joint positions [rad] that bring the foot to `goal` (3,) [m, base frame], or as near as limits allow.

    Damped Gauss–Newton from `near` (n,); of many solutions the one that it leads to.
    """
    rows, parameters = robot.joint_indices(limb), limb_parameters(robot, limb)
    low, high = robot.lower[rows] + 1e-3, robot.upper[rows] - 1e-3
    q = np.clip(near, low, high)
    steps = 1e-6 * np.eye(len(q))
    for _ in range(iterations):
        around = evaluate_limb(np.vstack([q, q + steps, q - steps]), parameters).foot
        miss = np.asarray(goal, dtype=float) - around[0]
        jacobian = (around[1 : len(q) + 1] - around[len(q) + 1 :]).T / 2e-6  # (3, n)
        normal = jacobian.T @ jacobian + 1e-8 * np.eye(len(q))
        step = np.clip(np.linalg.solve(normal, jacobian.T @ miss), -0.3, 0.3)
        after = np.clip(q + step, low, high)
        if np.abs(after - q).max() < 1e-12:
            break
        q = after
    return np.asarray(q, dtype=float)


def _posture(robot: RobotModel, posture: Posture | None) -> Array:
    """(n_J,) [rad]"""
    joints = np.array(robot.nominal.posture, dtype=float)
    if posture is None or posture == "nominal":
        return joints
    if isinstance(posture, str):
        known = robot.nominal.postures
        if posture not in known:
            names = ", ".join(("nominal", *known))
            raise InputError(Problem(robot.name, "posture", repr(posture), f"one of {names}, or limb → joints [rad]"))
        return np.array(known[posture], dtype=float)
    problems = []
    for name, values in posture.items():
        rows = robot.joint_indices(robot.limb(name))
        given = np.asarray(values, dtype=float)
        if given.shape != rows.shape or (given < robot.lower[rows]).any() or (given > robot.upper[rows]).any():
            expected = f"{len(rows)} joint positions within their limits [rad]"
            problems.append(Problem(robot.name, f"posture.{name}", repr(list(values)), expected))
            continue
        joints[rows] = given
    if problems:
        raise InputError(problems)
    return joints


def _bottoms(robot: RobotModel, joints: Array) -> Array:
    """(n_F,) height of the lowest point of every foot sphere in the base frame [m]."""
    feet = robot.foot_positions(np.zeros(6), joints)
    return np.asarray(feet[:, 2] - [limb.foot.radius for limb in robot.limbs])
