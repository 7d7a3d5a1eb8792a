"""Feet that stay on the ground while the body moves over them, rolling on their spheres."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.manipulation.inverse import tip_joints
from gaitforge.robot.kinematics import evaluate_limb, limb_parameters
from gaitforge.robot.limbs import Limb
from gaitforge.robot.model import RobotModel
from gaitforge.robot.rotation import matrices

Array = NDArray[np.float64]
PASSES = 4
"""A foot rolls by a fraction of the way that its joints turn it, so a few passes are exact."""


def standing_joints(robot: RobotModel, limb: Limb, base: Array, joints: Array, last: bool) -> Array:
    """(n, n_limb) joints [rad] of a limb whose foot stays in stance while the base takes `base` (n, 6).

    `joints` (n_limb,) are those of the first pose, or with `last` those of the last one; the centre of the
    sphere moves by rolling, e_k+1 − e_k = r (Δθ × ẑ).
    """
    parameters, radius = limb_parameters(robot, limb), limb.foot.radius
    turns, known = matrices(base[:, 3:]), -1 if last else 0
    home = evaluate_limb(joints[None], parameters).foot[0]
    place = base[known, :3] + turns[known] @ home
    centres = np.tile(place, (len(base), 1))
    q = np.tile(joints, (len(base), 1))
    for _ in range(PASSES):
        q = tip_joints(robot, limb, np.einsum("nji,nj->ni", turns, centres - base[:, :3]), q)
        rolled = turns @ evaluate_limb(q, parameters).rotation
        path = np.concatenate([np.zeros((1, 3)), np.cumsum(_rolling(rolled, radius), axis=0)])
        centres = place + path - path[known]
        centres[:, 2] = place[2]
    return q


def _rolling(rotations: Array, radius: float) -> Array:
    """(n − 1, 3) way of a sphere's centre between successive orientations (n, 3, 3) of its link."""
    forth = np.einsum("nij,nj->ni", rotations[1:], rotations[:-1, 2])
    back = np.einsum("nij,nj->ni", rotations[:-1], rotations[1:, 2])
    return np.asarray(0.5 * radius * (forth - back))
