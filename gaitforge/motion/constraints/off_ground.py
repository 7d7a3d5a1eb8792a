"""Limbs that do not move any more stay off the ground: the body is raised or tilted to lift them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from gaitforge.motion.family import Family
from gaitforge.motion.problem import Problem, kernel
from gaitforge.motion.trajectory import Trajectory, smooth_step

Point = tuple[str, tuple[float, float, float], float]
"""Limb, centre of a sphere that is fixed in the base frame [m], its radius [m]"""


@dataclass(frozen=True)
class OffGround(Family):
    """z + (R p)_z − r ≥ h for spheres (p, r) that are fixed in the base frame.

    In a segment that begins where the spheres are lower than h, the floor rises from there to h over the
    segment; at ends that neighbours have fixed nothing is asked.
    """

    name: ClassVar[str] = "off_ground"
    unit: ClassVar[str] = "m"
    points: tuple[Point, ...] = ()
    height: float = 0.01
    """[m]"""

    def add_to(self, problem: Problem, trajectory: Trajectory) -> None:
        """One row a sphere and sample."""
        grid = trajectory.grid
        free = np.arange(grid.samples)
        if grid.start is not None and not grid.start.rest:
            free = free[1:]
        if grid.end is not None and not grid.end.rest:
            free = free[:-1]
        compiled = kernel("off_ground", 6, 3, _instant)
        for limb, point, radius in self.points:
            floor = radius + self._floor(trajectory, np.array(point), radius)[free]
            labels = [(limb, int(k)) for k in free]
            rows = problem.add_rows(self.name, floor[:, None], np.inf, (len(free), 1), self.unit, labels)
            problem.add_term(self.name, compiled, trajectory.base[free], np.array(point), rows)

    def _floor(self, trajectory: Trajectory, point: np.ndarray, radius: float) -> np.ndarray:
        """(K,) [m]"""
        grid = trajectory.grid
        if grid.start is None or grid.start.rest:
            return np.full(grid.samples, self.height)
        begin = float(_height(grid.start.base, point)) - radius
        share = smooth_step(np.linspace(0.0, 1.0, grid.samples))
        low = min(begin, self.height)
        return np.asarray(low + share * (self.height - low))


def _height(base: np.ndarray, p: np.ndarray) -> float:
    """z + (R p)_z, the third row of R = Rz Ry Rx."""
    roll, pitch = base[3], base[4]
    across = np.sin(roll) * p[1] + np.cos(roll) * p[2]
    return float(base[2] - np.sin(pitch) * p[0] + np.cos(pitch) * across)


def _instant(v: Any, p: Any) -> Any:
    import casadi as ca

    across = ca.sin(v[3]) * p[1] + ca.cos(v[3]) * p[2]
    return v[2] - ca.sin(v[4]) * p[0] + ca.cos(v[4]) * across
