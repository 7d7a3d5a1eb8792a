"""A box between the tips of limbs: where they touch it, which joints squeeze, and how it is lifted unturned."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.manipulation.inverse import nearest_joints, tip_joints, unturned_joints
from gaitforge.robot.gravity import GRAVITY
from gaitforge.robot.kinematics import evaluate_limb, limb_parameters
from gaitforge.robot.limbs import Limb
from gaitforge.robot.model import RobotModel
from gaitforge.robot.rotation import matrices

Array = NDArray[np.float64]
ASIDE = np.array([0.0, 1.0, 0.0])
DEPTH = 0.015
"""[m] a squeezing tip is sent into the load: far enough for its joint to give all the effort it may"""


@dataclass(frozen=True, eq=False)
class Contact:
    """One tip on one side face of the box, in the frame of the box."""

    limb: Limb
    point: Array
    """(3,) on the face [m]"""
    normal: Array
    """(3,) out of the face"""
    squeezes: bool
    """Closed with a limited effort; the others are stiff"""

    def tip(self, poses: Array, gap: float, above: float = 0.0) -> Array:
        """(n, 3) centre of the tip's sphere `gap` off the face of a box at `poses` (n, 6) and `above` its place [m]."""
        local = self.point + (self.limb.foot.radius + gap) * self.normal + np.array([0.0, 0.0, above])
        return np.asarray(poses[:, :3] + matrices(poses[:, 3:]) @ local)


@dataclass(frozen=True, eq=False)
class Grasp:
    """Who holds a box, and where."""

    robot: RobotModel
    contacts: tuple[Contact, ...]

    @property
    def limbs(self) -> tuple[str, ...]:
        """Names of the limbs that hold."""
        return tuple(c.limb.name for c in self.contacts)

    def first_joints(self, pose: Array) -> dict[str, Array]:
        """limb → joints (n_limb,) with the tips on a box at `pose` (6,), the nearest to the nominal posture."""
        posture = self.robot.nominal.posture
        return {
            c.limb.name: nearest_joints(
                self.robot, c.limb, c.tip(pose[None], 0.0)[0], posture[self.robot.joint_indices(c.limb)]
            )
            for c in self.contacts
        }

    def joints(self, poses: Array, gap: float, near: Mapping[str, Array], above: float = 0.0) -> dict[str, Array]:
        """limb → (n, n_limb) joints with the tips `gap` [m] off a box at `poses` (n, 6) in base_link, `above` it.

        At a gap of 0 the joint that squeezes is sent on, by as much as would bring the tip `DEPTH` into the box.
        `near` (limb → joints): where to begin.
        """
        found = {}
        for c in self.contacts:
            q = tip_joints(self.robot, c.limb, c.tip(poses, gap, above), near[c.limb.name])
            if c.squeezes and not gap:
                which = self._lever(c, poses[0], q[0])[0]
                row = self.robot.joint_indices(c.limb)[which]
                levers = [self._lever(c, pose, joints)[1][which] for pose, joints in zip(poses, q, strict=True)]
                further = q[:, which] + DEPTH / np.array(levers)
                q[:, which] = np.clip(further, self.robot.lower[row], self.robot.upper[row])
            found[c.limb.name] = q
        return found

    def _lever(self, contact: Contact, pose: Array, q: Array) -> tuple[int, Array]:
        """The joint with the longest lever about the inward normal of the face, and all levers (n_limb,) [m]."""
        inward = -matrices(pose[3:]) @ contact.normal
        levers = _jacobian(self.robot, contact.limb, q).T @ inward
        return int(np.argmax(np.abs(levers))), levers

    def unturned(self, poses: Array, begin: Array, held: dict[str, Array]) -> Array:
        """The poses (n, 6) moved along x so that the tips do not turn about the faces' normals on the way.

        Two tips that spin on a box turn it with them, and nothing else holds its pitch; four hold it themselves.
        `held`: limb → joints (n_limb,) in the grasp of the box at `begin` (6,).
        """
        if len(self.contacts) > 2:
            return poses
        found = []
        for c in self.contacts:
            home = evaluate_limb(held[c.limb.name][None], limb_parameters(self.robot, c.limb)).foot
            tips = np.concatenate([home, home + poses[:, :3] - begin[:3]])
            q = unturned_joints(self.robot, c.limb, tips, ASIDE, held[c.limb.name])
            ahead = evaluate_limb(q, limb_parameters(self.robot, c.limb)).foot[:, 0]
            found.append(ahead[1:] - ahead[0])
        moved = np.array(poses)
        moved[:, 0] = begin[0] + np.mean(found, axis=0)
        return moved

    def efforts(self, pose: Array, joints: dict[str, Array], squeeze: float) -> dict[str, float]:
        """joint → effort limit [N m] with which squeezing tips press with `squeeze` [N] on a box at `pose` (6,).

        Of each such limb the joint with the longest lever about the face's normal squeezes, τ = |Jᵀ F + g|, g
        what the limb's own weight asks of it; the limb's other joints keep what they have.
        """
        limits = {}
        for c in self.contacts:
            if not c.squeezes:
                continue
            q = joints[c.limb.name]
            which, levers = self._lever(c, pose, q)
            weight = _gravity(self.robot, c.limb, q)[which]
            row = self.robot.joint_indices(c.limb)[which]
            limits[c.limb.joints[which]] = float(min(abs(squeeze * levers[which] + weight), self.robot.effort[row]))
        return limits


def side_grasp(robot: RobotModel, limbs: Sequence[str], size: Sequence[float], height: float, spread: float) -> Grasp:
    """Left limbs on the box's left face, right ones on its right face, `height` [m] above its centre.

    Limbs of one side are `spread` [m] apart, the first in front.  Of two limbs one is stiff and the other
    squeezes (were both limited, nothing would hold the box sideways); of more all squeeze alike.
    """
    contacts = []
    for side, sign in (("left", 1.0), ("right", -1.0)):
        group = [robot.limb(n) for n in limbs if robot.limb(n).side == side]
        group.sort(key=lambda limb: robot.limb_names.index(limb.name))
        for place, limb in enumerate(group):
            ahead = spread * (0.5 * (len(group) - 1) - place)
            point = np.array([ahead, sign * 0.5 * size[1], height])
            squeezes = len(limbs) > 2 or side == "left"
            contacts.append(Contact(limb, point, sign * ASIDE, squeezes))
    return Grasp(robot, tuple(contacts))


def _jacobian(robot: RobotModel, limb: Limb, q: Array, step: float = 1e-6) -> Array:
    """(3, n_limb) of the tip's position in base_link."""
    parameters = limb_parameters(robot, limb)
    steps = step * np.eye(len(q))
    ahead, behind = (evaluate_limb(q + s * steps, parameters).foot for s in (1.0, -1.0))
    return np.asarray((ahead - behind).T / (2 * step))


def _gravity(robot: RobotModel, limb: Limb, q: Array, step: float = 1e-6) -> Array:
    """(n_limb,) torque that holds the limb's own weight, the body level: the gradient of m g z [N m]."""
    parameters = limb_parameters(robot, limb)
    steps = step * np.eye(len(q))
    ahead, behind = (evaluate_limb(q + s * steps, parameters).moment[:, 2] for s in (1.0, -1.0))
    return np.asarray(GRAVITY * (ahead - behind) / (2 * step))
