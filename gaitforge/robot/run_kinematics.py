"""Feet, centre of mass and tools of a whole recorded run, by Pinocchio: independent of the simulator."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitforge.robot.model import RobotModel
from gaitforge.robot.rotation import matrices, quaternions

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class RunKinematics:
    """Where everything was, n rows; world frame."""

    feet: Array
    """(n, n_F, 3) centres of the foot spheres [m]"""
    contact_velocity: Array
    """(n, n_F, 3) velocity of the foot's material at the lowest point of its sphere [m/s]"""
    com: Array
    """(n, 3) [m]"""
    tools: dict[str, Array]
    """tool name → (n, 4, 4) pose of the tool frame"""


def run_kinematics(robot: RobotModel, base: Array, twists: Array, joints: Array, velocities: Array) -> RunKinematics:
    """Kinematics of n states.

    base (n, 6) poses of base_link, twists (n, 6) linear and angular velocity of its origin in world
    axes, joints and velocities (n, n_J).
    """
    import pinocchio as pin

    model, data = robot.pin, robot.pin.createData()
    q, v = _coordinates(robot, base, twists, joints, velocities)
    feet = [(limb.foot.link, np.array(limb.foot.offset)) for limb in robot.limbs]
    links = [link for link, _ in feet] + [tool.link for tool in robot.tools]
    frames = [model.frames[model.getFrameId(link, pin.FrameType.BODY)] for link in links]
    parents = [frame.parentJoint for frame in frames]
    pose, twist = np.zeros((len(q), len(links), 3, 4)), np.zeros((len(q), len(feet), 2, 3))
    com = np.zeros((len(q), 3))
    for row in range(len(q)):
        pin.forwardKinematics(model, data, q[row], v[row])
        com[row] = pin.centerOfMass(model, data, False)
        placements, motions = data.oMi, data.v
        for k, parent in enumerate(parents):
            placement = placements[parent]
            pose[row, k, :, :3], pose[row, k, :, 3] = placement.rotation, placement.translation
        for k in range(len(feet)):
            motion = motions[parents[k]]
            twist[row, k, 0], twist[row, k, 1] = motion.linear, motion.angular
    centres, lowest = _feet(robot, frames, pose, twist)
    tools = {
        tool.name: pose_product(pose[:, len(feet) + k], frames[len(feet) + k].placement.homogeneous @ tool.T_link_tool)
        for k, tool in enumerate(robot.tools)
    }
    return RunKinematics(centres, lowest, com, tools)


def _coordinates(
    robot: RobotModel, base: Array, twists: Array, joints: Array, velocities: Array
) -> tuple[Array, Array]:
    """Pinocchio's q (n, nq) and v (n, nv); the velocity of a free flyer is in its own axes."""
    model = robot.pin
    ids = [model.getJointId(name) for name in robot.joint_names]
    q, v = np.zeros((len(base), model.nq)), np.zeros((len(base), model.nv))
    R = matrices(base[:, 3:])
    q[:, :3], q[:, 3:7] = base[:, :3], quaternions(base[:, 3:])
    q[:, [model.joints[i].idx_q for i in ids]] = joints
    v[:, :3] = np.einsum("nij,ni->nj", R, twists[:, :3])
    v[:, 3:6] = np.einsum("nij,ni->nj", R, twists[:, 3:])
    v[:, [model.joints[i].idx_v for i in ids]] = velocities
    return q, v


def _feet(robot: RobotModel, frames: list[object], pose: Array, twist: Array) -> tuple[Array, Array]:
    """(n, n_F, 3) sphere centres and velocities of the spheres' lowest points."""
    count = len(robot.limbs)
    local = np.array(
        [
            frame.placement.act(np.array(limb.foot.offset))  # type: ignore[attr-defined]
            for frame, limb in zip(frames, robot.limbs, strict=False)
        ]
    )  # (n_F, 3) in the frame of the joint above
    R = pose[:, :count, :, :3]
    centres = np.einsum("nfij,fj->nfi", R, local) + pose[:, :count, :, 3]
    down = np.array([[0.0, 0.0, -limb.foot.radius] for limb in robot.limbs])
    linear = np.einsum("nfij,nfj->nfi", R, twist[:, :, 0] + np.cross(twist[:, :, 1], local))
    angular = np.einsum("nfij,nfj->nfi", R, twist[:, :, 1])
    return centres, linear + np.cross(angular, down)


def pose_product(pose: Array, T: Array) -> Array:
    """(n, 3, 4) poses times one (4, 4) → (n, 4, 4)."""
    out = np.zeros((len(pose), 4, 4))
    out[:, :3] = pose @ T
    out[:, 3, 3] = 1.0
    return out
