"""Where a limb comes to rest when its motors are off."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.bodies import limb_capsules
from gaitforge.motion.constraints.off_ground import Point
from gaitforge.robot.gravity import GRAVITY
from gaitforge.robot.kinematics import evaluate_limb, limb_parameters
from gaitforge.robot.limbs import Limb
from gaitforge.robot.model import RobotModel

Array = NDArray[np.float64]


def hanging_joints(
    robot: RobotModel, limb: Limb, joints: Array, body_height: float = np.inf, friction: float = 0.0
) -> Array:
    """(n,) joint positions [rad] in which a limb at `joints` (n,) comes to rest, its motors off.

    argmin over q of U(q) + friction Σ |q − joints|: gravity turns a joint until dry friction [N m] holds it.  The
    body is level, `body_height` [m] above the ground, and the foot no lower than the ground: a leg that is longer
    than the hip is high rests on it; inf: the limb hangs free.
    """
    from scipy.optimize import minimize

    rows, parameters = robot.joint_indices(limb), limb_parameters(robot, limb)
    low, high = robot.lower[rows], robot.upper[rows]
    start = np.clip(joints, low, high)
    count = len(start)

    def turned(x: Array) -> Array:
        """(n,) from how far each joint turns up, and how far down: the cost of friction is smooth in these."""
        return np.asarray(start + x[:count] - x[count:])

    def cost(x: Array) -> float:
        return GRAVITY * float(evaluate_limb(turned(x)[None], parameters).moment[0, 2]) + friction * float(x.sum())

    def above(x: Array) -> float:
        return float(evaluate_limb(turned(x)[None], parameters).foot[0, 2]) + body_height - limb.foot.radius

    found = minimize(
        cost,
        np.zeros(2 * count),
        method="SLSQP",
        bounds=[*((0.0, m) for m in high - start), *((0.0, m) for m in start - low)],
        constraints=[{"type": "ineq", "fun": above}] if np.isfinite(body_height) else [],
        options={"maxiter": 300, "ftol": 1e-11},
    )
    return np.asarray(np.clip(turned(found.x), low, high))


def gravity_torques(robot: RobotModel, limb: Limb, joints: Array) -> Array:
    """(n,) [N m] that gravity exerts on the joints of a limb that touches nothing, the body level; ∂U/∂q."""
    parameters, step = limb_parameters(robot, limb), 1e-6 * np.eye(len(joints))
    moved = evaluate_limb(np.vstack([joints + step, joints - step]), parameters).moment[:, 2]
    return np.asarray(GRAVITY * (moved[: len(joints)] - moved[len(joints) :]) / 2e-6)


def spheres(robot: RobotModel, limb: Limb, joints: Array) -> tuple[Point, ...]:
    """Foot and ends of capsules of what the limb's joints but the first move, in the frame of the body."""
    pose = evaluate_limb(joints[None], limb_parameters(robot, limb))
    found = [(pose.foot[0], limb.foot.radius)]
    for capsule in limb_capsules(robot):
        if capsule.limb == robot.limbs.index(limb) and capsule.joint >= 1:
            ends = pose.origins[0, capsule.joint] + np.array([capsule.a, capsule.b]) @ pose.turns[0, capsule.joint].T
            found += [(end, capsule.radius) for end in ends]
    return tuple((limb.name, (float(x), float(y), float(z)), radius) for (x, y, z), radius in found)


def lowest_point(robot: RobotModel, limb: Limb, joints: Array) -> float:
    """[m] height, in the frame of the level body, of the lowest point of what the limb's joints but the first move."""
    return min(point[2] - radius for _, point, radius in spheres(robot, limb, joints))
