"""How near a limb comes to a box."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.bodies import ends_in_base, limb_capsules
from gaitforge.robot.kinematics import evaluate_limb, limb_parameters
from gaitforge.robot.limbs import Limb
from gaitforge.robot.model import RobotModel
from gaitforge.robot.rotation import matrices

Array = NDArray[np.float64]
ALONG = 9
"""Points along a capsule's axis that are looked at."""


def box_gap(robot: RobotModel, limb: Limb, joints: Array, poses: Array, size: Sequence[float]) -> float:
    """[m] smallest distance between the limb's capsules and a box over n samples; ≤ 0 when they meet.

    joints (n, n_limb), poses (n, 6) of the box in base_link, size (3,) full edge lengths [m].
    """
    index = robot.limbs.index(limb)
    forward = {index: evaluate_limb(joints, limb_parameters(robot, limb))}
    R, half = matrices(poses[:, 3:]), 0.5 * np.asarray(size)
    nearest = np.inf
    for capsule in limb_capsules(robot):
        if capsule.limb != index:
            continue
        a, b = ends_in_base(capsule, forward, len(joints))
        for share in np.linspace(0.0, 1.0, ALONG):
            local = np.einsum("nji,nj->ni", R, a + share * (b - a) - poses[:, :3])
            outside = np.maximum(np.abs(local) - half, 0.0)
            nearest = min(nearest, float(np.linalg.norm(outside, axis=1).min()) - capsule.radius)
    return nearest
