"""Swinging feet near a smooth path: a height profile, and a way that begins and ends at rest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.family import Family, carried, carried_back
from gaitforge.motion.problem import Kernel, Problem, kernel
from gaitforge.motion.trajectory import Trajectory, planar_motion, smooth_step, swings


@dataclass(frozen=True)
class SwingProfile(Family):
    """∫ w (e_z − r − 1.1 h σ(1 − |2 s − 1|))² + w (e_xy − (1 − σ) e_lift − σ e_land)² dt

    s is the share of the swing that is over, σ = s³ (10 − 15 s + 6 s²): a foot that leaves and lands
    at rest in the world keeps the spline through the samples from ringing into the stance phases.
    """

    name: ClassVar[str] = "swing"
    unit: ClassVar[str] = "m² s"
    weight: float = 100.0
    """per m² s"""

    def add_to(self, problem: Problem, trajectory: Trajectory) -> None:
        """One place a swing sample whose swing begins and ends on the ground."""
        grid, robot = trajectory.grid, trajectory.robot
        height, path = kernel("swing_height", 1, 2, _height_instant), kernel("swing_path", 6, 8, _path_instant)
        for i in trajectory.moving:
            share = swing_share(grid.ground[:, i], grid.cyclic)
            here = np.flatnonzero(np.isfinite(share))
            up = smooth_step(1.0 - np.abs(2.0 * share[here] - 1.0))
            goal = robot.limbs[i].foot.radius + 1.1 * trajectory.step_height * up
            parameters = np.stack([np.full(len(here), self.weight * grid.dt), goal], axis=1)
            problem.add_term(self.name, height, trajectory.feet[i][here, 2:3], parameters)
            self._add_paths(problem, trajectory, i, path)

    def _add_paths(self, problem: Problem, trajectory: Trajectory, limb: int, compiled: Kernel) -> None:
        grid, feet = trajectory.grid, trajectory.feet[limb]
        places, parameters = [], []
        for lift, land in swings(grid.ground[:, limb], grid.cyclic):
            for k in range(lift + 1, land):
                s = (k - lift) / (land - lift)
                at = np.array([lift, k, land]) % grid.samples
                since, until = (self._motion(trajectory, n) for n in (k - lift, land - k))
                places.append(feet[at, :2].ravel())
                parameters.append([self.weight * grid.dt, float(smooth_step(s)), *since, *until])
        if places:
            problem.add_term(self.name, compiled, np.array(places), np.array(parameters))

    @staticmethod
    def _motion(trajectory: Trajectory, intervals: int) -> NDArray[np.float64]:
        """Motion of the commanded frame over some intervals (none outside gaits)."""
        grid = trajectory.grid
        return planar_motion(grid.command, intervals * grid.dt) if grid.cyclic else np.zeros(3)


def swing_share(ground: NDArray[np.bool_], cyclic: bool) -> NDArray[np.float64]:
    """(K,) how much of its swing is over at each sample in the air; NaN on the ground or at open swings."""
    share = np.full(len(ground), np.nan)
    for lift, land in swings(ground, cyclic):
        for k in range(lift + 1, land):
            share[k % len(ground)] = (k - lift) / (land - lift)
    return share


def _height_instant(v: Any, p: Any) -> Any:
    return p[0] * (v[0] - p[1]) ** 2


def _path_instant(v: Any, p: Any) -> Any:
    import casadi as ca

    lift = carried_back(ca.vertcat(v[:2], 0), p[2:5])
    land = carried(ca.vertcat(v[4:6], 0), p[5:8])
    return p[0] * ca.sumsqr(v[2:4] - (1 - p[1]) * lift[:2] - p[1] * land[:2])
