"""Inverse kinematics of one limb: joints that put the sphere at its end in its place."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from gaitforge.errors import InfeasibleMotion
from gaitforge.robot.kinematics import LimbPoses, evaluate_limb, limb_parameters
from gaitforge.robot.limbs import Limb
from gaitforge.robot.model import RobotModel

Array = NDArray[np.float64]
STEP_RAD = 1e-6
CLOSE_M = 1e-4
"""[m] or [rad]: a target missed by more is out of reach"""


def tip_joints(robot: RobotModel, limb: Limb, tips: Array, guess: Array) -> Array:
    """(n, n_limb) joints [rad] with the centre of the limb's sphere at `tips` (n, 3) [m, base_link].

    Newton from `guess` (n_limb,) or (n, n_limb), within the joint limits.  Raises `InfeasibleMotion` for a
    point out of reach.
    """

    def missed(pose: LimbPoses) -> Array:
        return np.asarray(pose.foot - tips)

    return _solve(robot, limb, missed, np.broadcast_to(guess, (len(tips), len(limb.joints))))


def unturned_joints(robot: RobotModel, limb: Limb, tips: Array, axis: Array, held: Array) -> Array:
    """(n, n_limb) joints that put the sphere at the y and z of `tips` (n, 3) and do not turn it about `axis`.

    x is where it comes to be: a tip that spins on what it presses against turns it.  `held` (n_limb,) are
    the joints with the turn that is kept, `axis` (3,) in base_link.
    """
    home = evaluate_limb(held[None], limb_parameters(robot, limb)).rotation[0]

    def missed(pose: LimbPoses) -> Array:
        turn = pose.rotation @ home.T
        skew = np.stack([turn[:, 2, 1] - turn[:, 1, 2], turn[:, 0, 2] - turn[:, 2, 0], turn[:, 1, 0] - turn[:, 0, 1]])
        return np.concatenate([(pose.foot - tips)[:, 1:], 0.5 * (axis @ skew)[:, None]], axis=1)

    return _solve(robot, limb, missed, np.tile(held, (len(tips), 1)))


def _solve(
    robot: RobotModel, limb: Limb, missed: Callable[[LimbPoses], Array], guess: Array, iterations: int = 60
) -> Array:
    rows = robot.joint_indices(limb)
    low, high = robot.lower[rows], robot.upper[rows]
    parameters = limb_parameters(robot, limb)
    q = np.clip(np.array(guess, dtype=float), low, high)
    for _ in range(iterations):
        error = missed(evaluate_limb(q, parameters))
        columns = [
            (missed(evaluate_limb(q + d, parameters)) - missed(evaluate_limb(q - d, parameters))) / (2 * STEP_RAD)
            for d in STEP_RAD * np.eye(len(rows))
        ]
        inverse = np.linalg.pinv(np.stack(columns, axis=2), rcond=1e-6)
        step = np.clip(-np.einsum("nij,nj->ni", inverse, error), -0.2, 0.2)
        q = np.clip(q + step, low, high)
        if np.abs(step).max() < 1e-12:
            break
    worst = np.abs(missed(evaluate_limb(q, parameters))).max()
    if worst > CLOSE_M:
        raise InfeasibleMotion(
            f"{limb.name} does not reach that far: {1000 * worst:.0f} mm are missing",
            {
                "families": ["reach"],
                "limbs": [limb.name],
                "value": float(worst),
                "unit": "m",
                "advice": "put the load nearer, higher or lower, or take limbs that reach it",
            },
        )
    return np.asarray(q)
