"""How far each foot can be set from its nominal foothold, and what that does to the centre of mass."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gaitforge.footfall.problem import FootfallProblem

if TYPE_CHECKING:
    from gaitforge.robot.model import RobotModel

Array = NDArray[np.float64]

RAYS = 8
"""Directions in which the reach is looked for"""
STEP = 0.02
"""[m] along a ray"""
FARTHEST = 0.2
"""[m] from the nominal foothold that a foot gets, its swing ahead and behind included"""
JOINT_MARGIN = 0.1
"""[rad] kept from the limits of the joints"""
APART = 0.8
"""Part of the nominal distance ahead of each other that neighbouring feet keep"""
TOLERANCE = 1e-6
"""[m] of inverse kinematics"""


@dataclass(frozen=True, eq=False)
class Reach:
    """What a body at its nominal height and attitude can do with its feet, in the base frame.

    Offsets of the feet from their nominal footholds are (n_F, 2) [m]; limbs that do not walk have none.
    """

    robot: RobotModel = field(repr=False)
    joints: Array = field(repr=False)
    """(n_J,) nominal posture, limbs that do not walk held [rad]"""
    walking: tuple[int, ...]
    footholds: Array
    """(n_F, 2) nominal [m]"""
    center_of_mass: Array
    """(2,) in the nominal posture [m]"""
    gain: Array = field(repr=False)
    """(n_F, 2, 2) derivative of the centre of mass by each foothold"""
    normals: Array = field(repr=False)
    """(n_F, RAYS, 2)"""
    extents: Array = field(repr=False)
    """(n_F, RAYS) [m]: n · offset ≤ extent"""
    neighbours: tuple[tuple[int, int, float], ...] = ()
    """(ahead, behind, least distance [m]) of feet that could meet"""

    def posture(self, offsets: Array) -> Array | None:
        """(n_J,) joint positions [rad] with the feet at their nominal footholds + `offsets`; None out of reach."""
        return _posture(self.robot, self.joints, self.walking, offsets)

    def center_of_mass_at(self, offsets: Array) -> Array | None:
        """(2,) exact centre of mass [m] of that posture, in the base frame; None out of reach."""
        joints = self.posture(offsets)
        return None if joints is None else self.center_of_mass_of(joints)

    def center_of_mass_of(self, joints: Array) -> Array:
        """(2,) exact centre of mass [m] of a posture (n_J,) [rad], in the base frame."""
        return self.robot.center_of_mass(_base(self.robot), joints)[:2]


def reach_of(robot: RobotModel, problem: FootfallProblem) -> Reach:
    """The reach of the limbs that walk in a problem of this robot.

    By inverse kinematics along rays on the ground, joint limits kept with a margin; the feet swing on by half
    of the longest stance phase to either side of a foothold, so that much is taken off ahead and behind.
    """
    walking = tuple(i for i, n in enumerate(problem.limbs) if n in problem.locomotive_anywhere)
    joints = robot.standing_on(problem.locomotive_anywhere)
    feet = robot.foot_positions(_base(robot), joints)[:, :2]
    center = robot.center_of_mass(_base(robot), joints)[:2]
    normals, extents, gain = _workspace(robot)
    return Reach(robot, joints, walking, feet, center, gain, normals, extents, _neighbours(problem, feet))


@lru_cache(maxsize=8)
def _workspace(robot: RobotModel) -> tuple[Array, Array, Array]:
    """Normals (n_F, RAYS, 2) and extents (n_F, RAYS) of each foot's reach, and the gain; a limb's are its own."""
    angles = np.arange(RAYS) * 2 * np.pi / RAYS
    rays = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    joints, everyone = np.array(robot.nominal.posture, dtype=float), tuple(range(len(robot.limbs)))
    corners = np.stack([_extent(robot, joints, everyone, ray)[:, None] * ray for ray in rays], axis=1)
    edge = np.roll(corners, -1, axis=1) - corners + 1e-9 * (np.roll(rays, -1, axis=0) - rays)
    normals = np.stack([edge[..., 1], -edge[..., 0]], axis=-1) / np.linalg.norm(edge, axis=-1, keepdims=True)
    extents = np.einsum("ird,ird->ir", normals, corners)
    nominal = robot.nominal
    half = 0.5 * nominal.speed * nominal.duration * max(0, nominal.columns - 2) / nominal.columns
    eroded = np.maximum(extents - half * np.abs(normals[..., 0]), 0.0)
    return normals, eroded, _gain(robot, joints, everyone)


def _base(robot: RobotModel) -> Array:
    return np.array([0.0, 0.0, robot.nominal.body_height, 0.0, 0.0, 0.0])


def _extent(robot: RobotModel, joints: Array, walking: tuple[int, ...], ray: Array) -> Array:
    """(n_F,) how far each foot gets along a ray [m]."""
    extent = np.zeros(len(robot.limbs))
    left, posture = list(walking), joints
    for length in np.arange(STEP, FARTHEST + STEP / 2, STEP):
        offsets = np.zeros((len(robot.limbs), 2))
        offsets[left] = ray * length
        posture, reached = _inverse(robot, joints, posture, left, offsets)
        left = [i for i in left if reached[i]]
        extent[left] = length
        if not left:
            break
    return extent


def _posture(robot: RobotModel, joints: Array, walking: tuple[int, ...], offsets: Array) -> Array | None:
    found, reached = _inverse(robot, joints, joints, list(walking), offsets)
    return found if reached[list(walking)].all() else None


def _inverse(
    robot: RobotModel, nominal: Array, begin: Array, limbs: list[int], offsets: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """Joint positions with the feet of `limbs` moved by `offsets` on the ground, and which of them got there.

    Damped Newton steps for all limbs at once: a foot depends on its own limb alone.
    """
    base, q = _base(robot), begin.copy()
    rows = {i: robot.joint_indices(robot.limbs[i]) for i in limbs}
    target = robot.foot_positions(base, nominal)
    target[:, :2] += offsets
    for _ in range(12):
        feet = robot.foot_positions(base, q)
        error = target - feet
        if not limbs or np.abs(error[limbs]).max() < TOLERANCE:
            break
        jacobians = _jacobians(robot, base, q, feet, rows)
        for i in limbs:
            jacobian = jacobians[i]
            damped = jacobian @ jacobian.T + 1e-10 * np.eye(3)
            q[rows[i]] += np.clip(jacobian.T @ np.linalg.solve(damped, error[i]), -0.3, 0.3)
    error = np.abs(target - robot.foot_positions(base, q)).max(axis=1)
    reached = np.zeros(len(robot.limbs), dtype=bool)
    for i in limbs:
        r = rows[i]
        inside = (q[r] >= robot.lower[r] + JOINT_MARGIN) & (q[r] <= robot.upper[r] - JOINT_MARGIN)
        reached[i] = bool(error[i] < 10 * TOLERANCE and inside.all())
    return q, reached


def _jacobians(
    robot: RobotModel, base: Array, q: Array, feet: Array, rows: dict[int, NDArray[np.intp]]
) -> dict[int, Array]:
    """(3, joints) of each limb's foot by its own joints, one difference for the k-th joints of all limbs."""
    step = 1e-6
    most = max(len(r) for r in rows.values())
    jacobians = {i: np.zeros((3, len(r))) for i, r in rows.items()}
    for k in range(most):
        moved = q.copy()
        for r in rows.values():
            if k < len(r):
                moved[r[k]] += step
        shifted = robot.foot_positions(base, moved)
        for i, r in rows.items():
            if k < len(r):
                jacobians[i][:, k] = (shifted[i] - feet[i]) / step
    return jacobians


def _gain(robot: RobotModel, joints: Array, walking: tuple[int, ...]) -> Array:
    """(n_F, 2, 2) ∂ centre of mass / ∂ foothold, at the nominal posture."""
    base, gain, step = _base(robot), np.zeros((len(robot.limbs), 2, 2)), 1e-3
    center = robot.center_of_mass(base, joints)[:2]
    for axis in range(2):
        offsets = np.zeros((len(robot.limbs), 2))
        offsets[:, axis] = step
        moved, _ = _inverse(robot, joints, joints, list(walking), offsets)
        for i in walking:
            rows, alone = robot.joint_indices(robot.limbs[i]), joints.copy()
            alone[rows] = moved[rows]
            gain[i, :, axis] = (robot.center_of_mass(base, alone)[:2] - center) / step
    return gain


def _neighbours(problem: FootfallProblem, feet: Array) -> tuple[tuple[int, int, float], ...]:
    pairs = []
    for side in set(problem.sides):
        row = sorted((i for i, s in enumerate(problem.sides) if s == side), key=lambda i: -feet[i, 0])
        pairs += [(a, b, APART * float(feet[a, 0] - feet[b, 0])) for a, b in pairwise(row)]
    return tuple(sorted(pairs))
