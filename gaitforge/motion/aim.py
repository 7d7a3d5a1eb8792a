"""Tool limbs that look at a point: the joints that put the optical axis through it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.trajectory import Array
from gaitforge.robot.kinematics import evaluate_limb, limb_parameters
from gaitforge.robot.limbs import Limb, ToolMount
from gaitforge.robot.model import RobotModel
from gaitforge.robot.rotation import matrices


def aim_joints(
    robot: RobotModel,
    limb: Limb,
    tool: ToolMount,
    base_poses: NDArray[np.float64],
    target: NDArray[np.float64],
    posture: NDArray[np.float64],
    iterations: int = 30,
) -> NDArray[np.float64]:
    """(n, n_limb) joint positions [rad] that point the tool at a target from each base pose.

    `base_poses` (n, 6), `target` (3,) in the world [m]; `posture` (n_limb,) is what the joint that is
    left over stays near.  Damped Gauss–Newton on the angle between axis and target, all poses
    at once, within the joint limits: where a limit is in the way the axis misses, and checks see it.
    """
    rows = robot.joint_indices(limb)
    low, high = robot.lower[rows] + 1e-3, robot.upper[rows] - 1e-3
    mount = _mount(robot, limb, tool)
    parameters = limb_parameters(robot, limb)
    goal = _in_base(base_poses, target)
    q = np.tile(np.clip(posture, low, high), (len(goal), 1))
    for _ in range(iterations):
        error = _error(q, parameters, mount, goal)
        jacobian = np.stack(
            [
                (_error(q + step, parameters, mount, goal) - _error(q - step, parameters, mount, goal)) / 2e-5
                for step in 1e-5 * np.eye(len(rows))
            ],
            axis=2,
        )  # (n, 2, n_limb)
        inverse = np.linalg.pinv(jacobian, rcond=1e-4)
        towards = -np.einsum("nij,nj->ni", inverse, error)
        home = posture - q
        rest = home - np.einsum("nij,njk,nk->ni", inverse, jacobian, home)
        step = np.clip(towards + 0.5 * rest, -0.3, 0.3)
        q = np.clip(q + step, low, high)
        if np.abs(step).max() < 1e-10:
            break
    return np.asarray(q, dtype=float)


def pointing_error(
    robot: RobotModel,
    limb: Limb,
    tool: ToolMount,
    base_poses: NDArray[np.float64],
    joints: NDArray[np.float64],
    target: NDArray[np.float64],
) -> NDArray[np.float64]:
    """(n,) angle [rad] between the optical axis and the target; `joints` (n, n_limb)."""
    missed = _error(joints, limb_parameters(robot, limb), _mount(robot, limb, tool), _in_base(base_poses, target))
    return np.asarray(np.linalg.norm(missed, axis=1))


class _Mount(NamedTuple):
    """Where a tool sits on its limb."""

    body: int
    """Which of the limb's joints moves it last"""
    T: Array
    """(4, 4) tool frame in the body of that joint"""


def _mount(robot: RobotModel, limb: Limb, tool: ToolMount) -> _Mount:
    import pinocchio

    own = {robot.pin.getJointId(name): number for number, name in enumerate(limb.joints)}
    frame = robot.pin.frames[robot.pin.getFrameId(tool.link, pinocchio.FrameType.BODY)]
    joint, placement = frame.parentJoint, frame.placement
    while joint not in own:  # a tool joint at its zero
        placement = robot.pin.jointPlacements[joint] * placement
        joint = robot.pin.parents[joint]
    return _Mount(own[joint], np.asarray(placement.homogeneous @ tool.T_link_tool, dtype=float))


def _in_base(base_poses: NDArray[np.float64], target: NDArray[np.float64]) -> Array:
    """(n, 3) the target seen from each base pose."""
    return np.asarray(np.einsum("nji,nj->ni", matrices(base_poses[:, 3:6]), target - base_poses[:, :3]))


def _error(q: Array, parameters: Array, mount: _Mount, goal: Array) -> Array:
    """(n, 2) [rad] the angle by which the axis misses the goal, as a vector across the axis; π when it points away."""
    pose = evaluate_limb(q, parameters)
    carrier, T = pose.turns[:, mount.body], mount.T
    turn, origin = carrier @ T[:3, :3], pose.origins[:, mount.body] + carrier @ T[:3, 3]
    seen = np.einsum("nji,nj->ni", turn, goal - origin)
    across = np.linalg.norm(seen[:, :2], axis=1)
    away = across < 1e-12  # no direction across the axis: on target, or exactly behind
    direction = np.where(away[:, None], [1.0, 0.0], seen[:, :2] / np.where(away, 1.0, across)[:, None])
    return np.asarray(np.arctan2(across, seen[:, 2])[:, None] * direction)
