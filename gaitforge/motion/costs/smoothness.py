"""Smooth joints and a smooth base."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.family import Family, carried, carried_back
from gaitforge.motion.problem import Problem, kernel
from gaitforge.motion.trajectory import Trajectory

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Smoothness(Family):
    """∫ w_q |q̈|² + w_p |p̈|² + w_θ |θ̈|² dt"""

    name: ClassVar[str] = "smoothness"
    unit: ClassVar[str] = "rad²/s³"
    joints: float = 1e-3
    """per (rad/s²)² s"""
    position: float = 1.0
    """per (m/s²)² s"""
    rotation: float = 1e-1
    """per (rad/s²)² s"""

    def add_to(self, problem: Problem, trajectory: Trajectory) -> None:
        """One place a limb and sample, one a sample for the base."""
        grid = trajectory.grid
        at = np.arange(grid.samples)
        before, after = grid.neighbours(at)
        ends = (grid.start, grid.end)
        for group in trajectory.alike:
            q, (limbs, count) = group.joints, group.rows.shape
            speeds = [np.zeros(group.rows.size) if e is None else e.joint_velocity[group.rows.ravel()] for e in ends]
            shared, added = np.split(self._parameters(trajectory, *speeds), [4], axis=1)
            parts = [np.broadcast_to(shared, (limbs, *shared.shape)), added.reshape(-1, limbs, count).swapaxes(0, 1)]
            compiled = kernel(("smooth", count, self.joints), 3 * count, 4 + count, self._joint_instant)
            places = np.concatenate([q[:, before], q, q[:, after]], axis=2)
            parameters = np.concatenate(parts, axis=2)
            problem.add_term(self.name, compiled, places, parameters.reshape(-1, 4 + count))
        speeds = [np.zeros(6) if e is None else e.base_velocity for e in ends]
        parameters = np.hstack([self._parameters(trajectory, *speeds), np.tile(grid.step, (grid.samples, 1))])
        compiled = kernel(("smooth_base", self.position, self.rotation), 18, 13, self._base_instant)
        base = trajectory.base
        problem.add_term(self.name, compiled, np.hstack([base[before], base[at], base[after]]), parameters)

    @staticmethod
    def _parameters(trajectory: Trajectory, start: Array, end: Array) -> Array:
        """(K, 4 + n) seconds, coefficients of the three samples, what end velocities add."""
        grid = trajectory.grid
        seconds = np.full((grid.samples, 1), grid.dt)
        if not grid.cyclic:
            seconds[[0, -1]] *= 0.5
        return np.hstack([seconds, *grid.accelerations(start, end)])

    def _joint_instant(self, v: Any, p: Any) -> Any:
        import casadi as ca

        n = v.shape[0] // 3
        return self.joints * p[0] * ca.sumsqr(p[1] * v[:n] + p[2] * v[n : 2 * n] + p[3] * v[2 * n :] + p[4:])

    def _base_instant(self, v: Any, p: Any) -> Any:
        import casadi as ca

        frame = p[10:13]
        before = ca.vertcat(carried_back(v[:3], frame), v[3:6])
        after = ca.vertcat(carried(v[12:15], frame), v[15:18])
        acceleration = p[1] * before + p[2] * v[6:12] + p[3] * after + p[4:10]
        return p[0] * (self.position * ca.sumsqr(acceleration[:3]) + self.rotation * ca.sumsqr(acceleration[3:]))
