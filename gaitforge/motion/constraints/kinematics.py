"""FK(q, base) = e and CoM(q, base) = x."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from gaitforge.motion.family import Family
from gaitforge.motion.problem import Problem, kernel
from gaitforge.motion.trajectory import Trajectory
from gaitforge.robot.kinematics import limb_forward, parameter_size, rpy_rotation


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
        for i in trajectory.moving:
            joints = trajectory.joints[i]
            count = joints.shape[1]
            compiled = kernel(("limb", count), 9 + count, parameter_size(count) + 1, _limb_instant)
            labels = [(robot.limbs[i].name, k) for k in range(samples)]
            rows = problem.add_rows("kinematics", 0.0, 0.0, (samples, 3), "m", labels)
            variables = np.hstack([trajectory.base, joints, trajectory.feet[i]])
            parameters = np.concatenate([trajectory.parameters[i], [mass]])
            problem.add_term("kinematics", compiled, variables, parameters, np.hstack([rows, com_rows]))


def _rigid_mass(trajectory: Trajectory) -> float:
    """Mass of the base with all limbs that do not move."""
    moving = sum(
        trajectory.parameters[i][15 : 15 + 19 * trajectory.joints[i].shape[1] : 19].sum() for i in trajectory.moving
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
    mass = sum(p[19 * i + 15] for i in range(count))
    return ca.vertcat(
        base[:3] + rotation @ state.foot - foot,
        -(mass * base[:3] + rotation @ state.moment) / p[-1],
    )
