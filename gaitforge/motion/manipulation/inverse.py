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
GRID, STARTS = 13, 12
"""Points along a joint's range, and how many of all are tried."""
CLOSE_M = 1e-4
"""[m] or [rad]: a target missed by more is out of reach"""


def tip_joints(robot: RobotModel, limb: Limb, tips: Array, guess: Array) -> Array:
    """(n, n_limb) joints [rad] with the centre of the limb's sphere at `tips` (n, 3) [m, base_link].

    Newton from `guess` (n_limb,) or (n, n_limb), within the joint limits.  Raises `InfeasibleMotion` for a
    point out of reach.
    """

    def missed(pose: LimbPoses, samples: slice) -> Array:
        return np.asarray(pose.foot - tips[samples])

    return _solve(robot, limb, missed, np.broadcast_to(guess, (len(tips), len(limb.joints))))


def nearest_joints(robot: RobotModel, limb: Limb, tip: Array, posture: Array) -> Array:
    """(n_limb,) of all joints that put the sphere at `tip` (3,) [m, base_link] those that are nearest to `posture`.

    Newton from the points of a grid over the joint limits whose tips are nearest.  Raises `InfeasibleMotion`.
    """
    rows = robot.joint_indices(limb)
    low, high = robot.lower[rows], robot.upper[rows]
    axes = [np.linspace(a, b, GRID) for a, b in zip(low, high, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(rows))
    missed = np.linalg.norm(evaluate_limb(grid, limb_parameters(robot, limb)).foot - tip, axis=1)
    found, refused = [], None
    for begin in grid[np.argsort(missed, kind="stable")[:STARTS]]:
        try:
            found.append(tip_joints(robot, limb, tip[None], begin)[0])
        except InfeasibleMotion as error:
            refused = refused or error
    if not found:
        assert refused is not None
        raise refused
    return min(found, key=lambda q: float(np.linalg.norm(q - posture)))


def unturned_joints(robot: RobotModel, limb: Limb, tips: Array, axis: Array, held: Array) -> Array:
    """(n, n_limb) joints that put the sphere at the y and z of `tips` (n, 3) and do not turn it about `axis`.

    x is where it comes to be: a tip that spins on what it presses against turns it.  `held` (n_limb,) are
    the joints with the turn that is kept, `axis` (3,) in base_link.
    """
    home = evaluate_limb(held[None], limb_parameters(robot, limb)).rotation[0]

    def missed(pose: LimbPoses, samples: slice) -> Array:
        turn = pose.rotation @ home.T
        skew = np.stack([turn[:, 2, 1] - turn[:, 1, 2], turn[:, 0, 2] - turn[:, 2, 0], turn[:, 1, 0] - turn[:, 0, 1]])
        return np.concatenate([(pose.foot - tips[samples])[:, 1:], 0.5 * (axis @ skew)[:, None]], axis=1)

    return _solve(robot, limb, missed, np.tile(held, (len(tips), 1)))


Missed = Callable[[LimbPoses, slice], Array]
"""(poses at some samples, which) → (n, 3) by how much they miss their targets"""


def _solve(robot: RobotModel, limb: Limb, missed: Missed, guess: Array, iterations: int = 60) -> Array:
    rows = robot.joint_indices(limb)
    low, high = robot.lower[rows], robot.upper[rows]
    parameters, every = limb_parameters(robot, limb), slice(None)
    q = np.clip(np.array(guess, dtype=float), low, high)
    for _ in range(iterations):
        error = missed(evaluate_limb(q, parameters), every)
        columns = [
            (missed(evaluate_limb(q + d, parameters), every) - missed(evaluate_limb(q - d, parameters), every))
            / (2 * STEP_RAD)
            for d in STEP_RAD * np.eye(len(rows))
        ]
        inverse = np.linalg.pinv(np.stack(columns, axis=2), rcond=1e-6)
        step = np.clip(-np.einsum("nij,nj->ni", inverse, error), -0.2, 0.2)
        q = np.clip(q + step, low, high)
        if np.abs(step).max() < 1e-12:
            break
    for k in np.flatnonzero(np.abs(missed(evaluate_limb(q, parameters), every)).max(axis=1) > CLOSE_M):
        q[k] = _within_limits(missed, slice(k, k + 1), q[k - 1] if k else np.asarray(guess)[0], parameters, low, high)
    _refuse_unreached(limb, missed(evaluate_limb(q, parameters), every))
    return np.asarray(q)


def _within_limits(missed: Missed, sample: slice, begin: Array, parameters: Array, low: Array, high: Array) -> Array:
    """(n_limb,) for one sample: near the limits Newton's steps end at them, a trust region walks along."""
    from scipy.optimize import least_squares

    inside = np.clip(begin, low + 1e-6, high - 1e-6)
    found = least_squares(
        lambda q: missed(evaluate_limb(q[None], parameters), sample)[0],
        inside,
        bounds=(low, high),
        xtol=1e-14,
        gtol=1e-14,
    )
    return np.asarray(found.x)


def _refuse_unreached(limb: Limb, missed: Array) -> None:
    worst = float(np.abs(missed).max())
    if worst > CLOSE_M:
        raise InfeasibleMotion(
            f"{limb.name} does not reach that far: {1000 * worst:.0f} mm are missing",
            {
                "families": ["reach"],
                "limbs": [limb.name],
                "value": worst,
                "unit": "m",
                "advice": "put the load nearer, higher or lower, or take limbs that reach it",
            },
        )
