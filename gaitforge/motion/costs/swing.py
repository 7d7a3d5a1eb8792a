"""Swinging feet near a smooth path: a height profile, and a way that begins and ends at rest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.family import Family, carried, carried_back
from gaitforge.motion.problem import Kernel, Problem, kernel
from gaitforge.motion.trajectory import Discretisation, Trajectory, planar_motion, smooth_step, swings


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
        motions = _motions(grid)
        height, path = kernel("swing_height", 1, 2, _height_instant), kernel("swing_path", 6, 8, _path_instant)
        for i in trajectory.moving:
            share = swing_share(grid.ground[:, i], grid.cyclic)
            here = np.flatnonzero(np.isfinite(share))
            up = smooth_step(1.0 - np.abs(2.0 * share[here] - 1.0))
            goal = robot.limbs[i].foot.radius + 1.1 * trajectory.step_height * up
            parameters = np.stack([np.full(len(here), self.weight * grid.dt), goal], axis=1)
            problem.add_term(self.name, height, trajectory.feet[i][here, 2:3], parameters)
            self._add_paths(problem, trajectory, i, path, motions)

    def _add_paths(
        self, problem: Problem, trajectory: Trajectory, limb: int, compiled: Kernel, motions: NDArray[np.float64]
    ) -> None:
        grid, feet = trajectory.grid, trajectory.feet[limb]
        places, parameters = [], []
        for lift, land in swings(grid.ground[:, limb], grid.cyclic):
            k = np.arange(lift + 1, land)
            done = smooth_step((k - lift) / (land - lift))
            ends = np.array([lift, land]) % grid.samples
            ways = [np.broadcast_to(feet[end, :2], (len(k), 2)) for end in ends]
            places.append(np.hstack([ways[0], feet[k % grid.samples, :2], ways[1]]))
            weights = np.full((len(k), 1), self.weight * grid.dt)
            parameters.append(np.hstack([weights, done[:, None], motions[k - lift], motions[land - k]]))
        if places:
            problem.add_term(self.name, compiled, np.vstack(places), np.vstack(parameters))


def _motions(grid: Discretisation) -> NDArray[np.float64]:
    """(K + 1, 3) motion of the commanded frame over 0, 1, … intervals (none outside gaits)."""
    if not grid.cyclic:
        return np.zeros((grid.samples + 1, 3))
    return planar_motion(grid.command, np.arange(grid.samples + 1) * grid.dt)


def swing_share(ground: NDArray[np.bool_], cyclic: bool) -> NDArray[np.float64]:
    """(K,) how much of its swing is over at each sample in the air; NaN on the ground or at open swings."""
    share = np.full(len(ground), np.nan)
    for lift, land in swings(ground, cyclic):
        k = np.arange(lift + 1, land)
        share[k % len(ground)] = (k - lift) / (land - lift)
    return share


def _height_instant(v: Any, p: Any) -> Any:
    return p[0] * (v[0] - p[1]) ** 2


def _path_instant(v: Any, p: Any) -> Any:
    import casadi as ca

    lift = carried_back(ca.vertcat(v[:2], 0), p[2:5])
    land = carried(ca.vertcat(v[4:6], 0), p[5:8])
    return p[0] * ca.sumsqr(v[2:4] - (1 - p[1]) * lift[:2] - p[1] * land[:2])
