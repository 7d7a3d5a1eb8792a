"""Where a limb comes to rest when its motors are off."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitforge.robot.kinematics import evaluate_limb, limb_parameters
from gaitforge.robot.limbs import Limb
from gaitforge.robot.model import RobotModel

Array = NDArray[np.float64]


def hanging_joints(robot: RobotModel, limb: Limb, joints: Array, body_height: float) -> Array:
    """(n,) joint positions [rad] with the limb's centre of mass as low as it gets, downhill from `joints` (n,).

    The body is level, `body_height` [m] above the ground, and the foot no lower than the ground: a leg that is
    longer than the hip is high rests on it.  Friction is left out: joints that gravity does not turn stay.
    """
    from scipy.optimize import minimize

    rows, parameters = robot.joint_indices(limb), limb_parameters(robot, limb)
    low, high = robot.lower[rows], robot.upper[rows]

    def height(q: Array) -> float:
        return float(evaluate_limb(q[None], parameters).moment[0, 2])

    def above(q: Array) -> float:
        return float(evaluate_limb(q[None], parameters).foot[0, 2]) + body_height - limb.foot.radius

    start = np.clip(joints, low, high)
    found = minimize(
        height,
        start,
        method="SLSQP",
        bounds=list(zip(low, high, strict=True)),
        constraints=[{"type": "ineq", "fun": above}],
        options={"maxiter": 200, "ftol": 1e-10},
    )
    return np.asarray(np.clip(found.x, low, high))
