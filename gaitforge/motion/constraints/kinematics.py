"""FK(q, base) = e and CoM(q, base) = x."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from gaitforge.motion.family import Family
from gaitforge.motion.problem import Problem, kernel
from gaitforge.motion.trajectory import Trajectory
from gaitforge.motion.turning import RPY, chain_axes, first, place, second
from gaitforge.robot.kinematics import JOINT_PARAMETERS, joint_axes, limb_forward, parameter_size, rpy_rotation


@dataclass(frozen=True)
class Kinematics(Family):
    """Feet where the joints put them, and the centre of mass of all bodies."""

    name: ClassVar[str] = "kinematics"
    unit: ClassVar[str] = "m"

    def add_to(self, problem: Problem, trajectory: Trajectory) -> None:
        """Three rows a foot and sample, three rows a sample for the centre of mass (scaled by the mass)."""
        robot, samples = trajectory.robot, trajectory.grid.samples
        com_rows = problem.add_rows("center_of_mass", 0.0, 0.0, (samples, 3), "m", range(samples))
        mass = robot.mass
        own = kernel("com_base", 9, 5, _base_instant)
        lumped = np.concatenate([[trajectory.base_mass, mass], trajectory.base_moment])
        lumped[0] = _rigid_mass(trajectory)
        variables = np.hstack([trajectory.base, trajectory.com])
        problem.add_term("center_of_mass", own, variables, lumped, com_rows)
        for group in trajectory.alike:
            limbs, count = group.rows.shape
            compiled = kernel(("limb", count), 9 + count, parameter_size(count) + 1, _limb_instant, _limb_derivatives)
            labels = [(robot.limbs[i].name, k) for i in group.limbs for k in range(samples)]
            rows = problem.add_rows("kinematics", 0.0, 0.0, (limbs * samples, 3), "m", labels)
            base = np.broadcast_to(trajectory.base, (limbs, samples, 6))
            variables = np.concatenate([base, group.joints, group.feet], axis=2)
            parameters = np.repeat(np.insert(group.parameters, parameter_size(count), mass, axis=1), samples, axis=0)
            results = np.hstack([rows, np.tile(com_rows, (limbs, 1))])
            problem.add_term("kinematics", compiled, variables, parameters, results)


def _rigid_mass(trajectory: Trajectory) -> float:
    """Mass of the base with all limbs that do not move."""
    moving = sum(
        group.parameters[:, 15 : JOINT_PARAMETERS * group.rows.shape[1] : JOINT_PARAMETERS].sum()
        for group in trajectory.alike
    )
    return float(trajectory.robot.mass - moving)


def _base_instant(v: Any, p: Any) -> Any:
    """x − (m_0 b + R μ_0) / m"""
    base, com = v[:6], v[6:9]
    rotation = rpy_rotation(base[3:6])
    return com - (p[0] * base[:3] + rotation @ p[2:5]) / p[1]


def _limb_instant(v: Any, p: Any) -> Any:
    """b + R p(q) − e, and this limb's share of the centre of mass."""
    import casadi as ca

    count = v.shape[0] - 9
    base, joints, foot = v[:6], v[6 : 6 + count], v[6 + count :]
    state = limb_forward(joints, p[:-1])
    rotation = rpy_rotation(base[3:6])
    mass = sum(p[JOINT_PARAMETERS * i + 15] for i in range(count))
    return ca.vertcat(
        base[:3] + rotation @ state.foot - foot,
        -(mass * base[:3] + rotation @ state.moment) / p[-1],
    )


def _limb_derivatives(v: Any, p: Any, multiplier: Any) -> tuple[Any, Any]:
    """The foot is a point of the chain, the share of the centre of mass a sum of points with masses."""
    import casadi as ca

    count = v.shape[0] - 9
    rpy, joints, total = v[3:6], v[6 : 6 + count], p[-1]
    state = limb_forward(joints, p[:-1])
    rotation = rpy_rotation(rpy)
    axes, at = chain_axes(rpy, state, joint_axes(p[:-1], count)), [*RPY, *range(6, 6 + count)]
    feet = first(axes, [state.foot] * 3 + [state.foot - origin for origin in state.origins])
    lumps = first(axes, [state.moment] * 3 + _distal_moments(state, p, count))
    jacobian, hessian = ca.SX(6, 9 + count), ca.SX(9 + count, 9 + count)
    mass = sum(p[JOINT_PARAMETERS * i + 15] for i in range(count))
    for k in range(3):
        jacobian[k, k], jacobian[k, 6 + count + k], jacobian[3 + k, k] = 1, -1, -mass / total
    for i, column in enumerate(at):
        jacobian[:3, column] = rotation @ feet[i]
        jacobian[3:, column] = -(rotation @ lumps[i]) / total
    place(hessian, at, second(axes, feet, rotation.T @ multiplier[:3]))
    place(hessian, at, second(axes, lumps, -(rotation.T @ multiplier[3:]) / total))
    return jacobian, hessian


def _distal_moments(state: Any, p: Any, count: int) -> list[Any]:
    """Per joint: Σ mass · (centre of mass − the joint's origin) over the bodies that it moves."""
    arms: list[Any] = []
    mass: Any = 0
    moment: Any = 0
    for i in reversed(range(count)):
        at = JOINT_PARAMETERS * i + 15
        mass = mass + p[at]
        moment = moment + p[at] * state.origins[i] + state.turns[i] @ p[at + 1 : at + 4]
        arms.append(moment - mass * state.origins[i])
    return arms[::-1]
