"""Kinematics of one limb in CasADi, from the placements and axes of the Pinocchio model.

The limb is the unit: its forward kinematics depends on the base pose and its own joints alone, so
one small function per number of joints, with the limb's geometry as a parameter vector, mapped over
limbs and samples, is all the symbolic kinematics there is.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Any, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from gaitforge.errors import InputError, Problem
from gaitforge.robot.limbs import Limb
from gaitforge.robot.model import RobotModel
from gaitforge.robot.rotation import matrices

Array = NDArray[np.float64]
JOINT_PARAMETERS = 19
"""Per joint: rotation (9, column-major), translation (3), axis (3), mass (1), first moment (3)."""


class LimbState(NamedTuple):
    """Symbolic (or numeric) outcome of a limb's forward kinematics in the base frame."""

    foot: Any
    """(3,) centre of the foot sphere [m]"""
    rotation: Any
    """(3, 3) orientation of the foot link"""
    moment: Any
    """(3,) Σ mass · centre of mass of the limb's bodies [kg m]"""
    origins: list[Any]
    """(3,) each joint's origin [m]"""
    turns: list[Any]
    """(3, 3) orientation of each joint's body"""


def parameter_size(joints: int) -> int:
    """Length of a limb's parameter vector."""
    return JOINT_PARAMETERS * joints + 3


@cache
def _rodrigues() -> Any:
    import casadi as ca

    axis, angle = ca.SX.sym("axis", 3), ca.SX.sym("angle")
    c, s = ca.cos(angle), ca.sin(angle)
    rotation = c * ca.SX.eye(3) + (1 - c) * axis @ axis.T + s * ca.skew(axis)
    return ca.Function("rodrigues", [axis, angle], [rotation])


def rpy_rotation(rpy: Any) -> Any:
    """Rz(yaw) Ry(pitch) Rx(roll) of a symbolic (3,) roll, pitch, yaw."""
    import casadi as ca

    cr, sr, cp, sp, cy, sy = (f(rpy[i]) for i in range(3) for f in (ca.cos, ca.sin))
    return ca.vertcat(
        ca.horzcat(cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        ca.horzcat(sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        ca.horzcat(-sp, cp * sr, cp * cr),
    )


def limb_forward(joints: Any, parameters: Any) -> LimbState:
    """Forward kinematics of a limb in the base frame; `joints` (n,), `parameters` by `limb_parameters`."""
    import casadi as ca

    count = joints.shape[0]
    rotation: Any = ca.SX.eye(3)
    position: Any = ca.SX.zeros(3)
    moment: Any = ca.SX.zeros(3)
    origins, turns = [], []
    for i in range(count):
        p = parameters[JOINT_PARAMETERS * i : JOINT_PARAMETERS * (i + 1)]
        position = position + rotation @ p[9:12]
        rotation = rotation @ ca.reshape(p[:9], 3, 3) @ _rodrigues()(p[12:15], joints[i])
        moment = moment + p[15] * position + rotation @ p[16:19]
        origins.append(position)
        turns.append(rotation)
    foot = position + rotation @ parameters[JOINT_PARAMETERS * count :]
    return LimbState(foot, rotation, moment, origins, turns)


def joint_axes(parameters: Any, count: int) -> list[Any]:
    """(3,) axis of each joint in the frame of the body that it moves."""
    starts = [JOINT_PARAMETERS * i + 12 for i in range(count)]
    return [parameters[at : at + 3] for at in starts]


_known: WeakKeyDictionary[RobotModel, dict[Limb, Array]] = WeakKeyDictionary()


def limb_parameters(robot: RobotModel, limb: Limb) -> Array:
    """(19 n + 3,) the geometry and masses of a limb; tool joints are taken at their nominal position."""
    known = _known.setdefault(robot, {})
    if limb not in known:
        known[limb] = _limb_parameters(robot, limb)
        known[limb].setflags(write=False)
    return known[limb]


def _limb_parameters(robot: RobotModel, limb: Limb) -> Array:
    import pinocchio

    model, parts, parent = robot.pin, [], 1
    for name in limb.joints:
        index = model.getJointId(name)
        if model.parents[index] != parent:
            raise InputError(
                Problem(robot.name, name, f"a joint on {model.names[model.parents[index]]}", "a chain from the base")
            )
        axis = _axis(robot, name)
        mass, moment = _body(robot, index, limb)
        placement = model.jointPlacements[index]
        rotation = placement.rotation.reshape(9, order="F")
        parts.append(np.concatenate([rotation, placement.translation, axis, [mass], moment]))
        parent = index
    frame = model.frames[model.getFrameId(limb.foot.link, pinocchio.FrameType.BODY)]
    if frame.parentJoint != parent:
        raise InputError(Problem(robot.name, limb.foot.link, "a foot that the last joint does not move", "the tip"))
    parts.append(frame.placement.act(np.array(limb.foot.offset)))
    return np.concatenate(parts)


def _axis(robot: RobotModel, name: str) -> Array:
    joint = robot.pin.joints[robot.pin.getJointId(name)]
    data = joint.createData()
    joint.calc(data, np.zeros(joint.nq), np.zeros(joint.nv))
    subspace = np.asarray(data.S).reshape(6, -1)
    if subspace.shape[1] != 1 or np.abs(subspace[:3]).max() > 1e-12:
        raise InputError(Problem(robot.name, name, f"a {joint.shortname()}", "a revolute joint with limits"))
    return np.array(subspace[3:, 0])


def _body(robot: RobotModel, index: int, limb: Limb) -> tuple[float, Array]:
    """Mass and first moment of the body of a joint, tool bodies that hang on it included."""
    inertia = robot.pin.inertias[index]
    mass, moment = float(inertia.mass), inertia.mass * np.asarray(inertia.lever)
    for name in limb.tool_joints:
        child = robot.pin.getJointId(name)
        if robot.pin.parents[child] == index:
            angle = float(robot.nominal.posture[robot.joint_names.index(name)])
            placement = robot.pin.jointPlacements[child]
            turn = np.asarray(_rodrigues()(_axis(robot, name), angle))
            inner_mass, inner = _body(robot, child, limb)
            mass += inner_mass
            moment = moment + inner_mass * placement.translation + placement.rotation @ turn @ inner
    return mass, moment


def base_body(robot: RobotModel) -> tuple[float, Array]:
    """Mass [kg] and first moment [kg m] of what is rigidly part of the base."""
    inertia = robot.pin.inertias[1]
    return float(inertia.mass), float(inertia.mass) * np.array(inertia.lever)


class LimbPoses(NamedTuple):
    """Numeric forward kinematics of a limb at n configurations, base frame."""

    foot: Array
    """(n, 3) [m]"""
    rotation: Array
    """(n, 3, 3)"""
    moment: Array
    """(n, 3) [kg m]"""
    origins: Array
    """(n, joints, 3) joint origins [m]"""
    turns: Array
    """(n, joints, 3, 3) orientation of each joint's body"""


def evaluate_limb(joints: Array, parameters: Array) -> LimbPoses:
    """Forward kinematics of one limb at (n, n_joints) joint positions."""
    return LimbPoses(*(part[0] for part in _forward(joints[None], _links(parameters[None]))))


def evaluate_limbs(robot: RobotModel, joints: Array) -> dict[int, LimbPoses]:
    """Limb index → forward kinematics at (n, n_J) joint positions of the robot; limbs alike are taken together."""
    poses: dict[int, LimbPoses] = {}
    for members, _, found in evaluate_alike(robot, joints):
        poses |= {i: LimbPoses(*(part[k] for part in found)) for k, i in enumerate(members)}
    return {i: poses[i] for i in range(len(robot.limbs))}


def evaluate_alike(robot: RobotModel, joints: Array) -> Iterator[tuple[list[int], NDArray[np.intp], LimbPoses]]:
    """Limbs with equally many joints, their joints among all (L, n_joints), and their poses, with L in front."""
    for members, rows, links in _alike(robot):
        yield members, rows, LimbPoses(*_forward(joints[:, rows].transpose(1, 0, 2), links))


class _Links(NamedTuple):
    """What the forward kinematics of L limbs with n joints each make of their parameters.

    A joint at angle q turns its body by `still` + cos q `cosine` + sin q `sine` (Rodrigues' formula).
    """

    still: Array
    """(L, n, 3, 3)"""
    cosine: Array
    sine: Array
    offset: Array
    """(L, n, 3) of the joint from the one before"""
    mass: Array
    """(L, n)"""
    moment: Array
    """(L, n, 3) first moment of the body"""
    foot: Array
    """(L, 3) in the frame of the last body"""


_robots: WeakKeyDictionary[RobotModel, tuple[tuple[list[int], NDArray[np.intp], _Links], ...]] = WeakKeyDictionary()


def _alike(robot: RobotModel) -> tuple[tuple[list[int], NDArray[np.intp], _Links], ...]:
    """Limbs with equally many joints, their joints among all (L, n), and their links."""
    if robot not in _robots:
        alike: dict[int, list[int]] = {}
        for i, limb in enumerate(robot.limbs):
            alike.setdefault(len(limb.joints), []).append(i)
        _robots[robot] = tuple(
            (
                members,
                np.array([robot.joint_indices(robot.limbs[i]) for i in members]),
                _links(np.array([limb_parameters(robot, robot.limbs[i]) for i in members])),
            )
            for members in alike.values()
        )
    return _robots[robot]


def _links(parameters: Array) -> _Links:
    limbs, size = parameters.shape
    count = (size - 3) // JOINT_PARAMETERS
    p = parameters[:, : JOINT_PARAMETERS * count].reshape(limbs, count, JOINT_PARAMETERS)
    placed, axis = p[..., :9].reshape(limbs, count, 3, 3).swapaxes(2, 3), p[..., 12:15]
    along = placed @ (axis[..., :, None] * axis[..., None, :])
    foot = parameters[:, JOINT_PARAMETERS * count :]
    return _Links(along, placed - along, placed @ _skew(axis), p[..., 9:12], p[..., 15], p[..., 16:19], foot)


def _forward(joints: Array, links: _Links) -> tuple[Array, ...]:
    """The fields of `LimbPoses` for L limbs: joints (L, n, n_joints)."""
    limbs, n, count = joints.shape
    position, moment = np.zeros((limbs, n, 3)), np.zeros((limbs, n, 3))
    origins, turns = np.empty((limbs, n, count, 3)), np.empty((limbs, n, count, 3, 3))
    c, s = np.cos(joints)[..., None, None], np.sin(joints)[..., None, None]
    turned = links.still[:, None] + c * links.cosine[:, None] + s * links.sine[:, None]
    rotation = np.eye(3)
    for i in range(count):
        position = position + _turned(rotation, links.offset[:, None, i])
        rotation = rotation @ turned[:, :, i]
        moment = moment + links.mass[:, None, i, None] * position + _turned(rotation, links.moment[:, None, i])
        origins[:, :, i], turns[:, :, i] = position, rotation
    foot = position + _turned(rotation, links.foot[:, None])
    return foot, rotation, moment, origins, turns


def _turned(rotation: Array, vector: Array) -> Array:
    return np.asarray((rotation @ vector[..., None])[..., 0])


def _skew(axis: Array) -> Array:
    """(…, 3, 3) [a]× of (…, 3)."""
    x, y, z = np.moveaxis(axis, -1, 0)
    o = np.zeros_like(x)
    return np.stack([np.stack([o, -z, y], -1), np.stack([z, o, -x], -1), np.stack([-y, x, o], -1)], axis=-2)


def feet_in_world(robot: RobotModel, base_poses: Array, joints: Array) -> Array:
    """(n, n_F, 3) centres of the foot spheres [m] at n base poses (n, 6) and joint positions (n, n_J)."""
    feet = np.stack([pose.foot for pose in evaluate_limbs(robot, joints).values()], axis=1)
    return np.asarray(base_poses[:, None, :3] + np.einsum("nij,nfj->nfi", matrices(base_poses[:, 3:6]), feet))
