"""Swinging feet near a smooth path: a height profile, and a way that begins and ends at rest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.family import Family, carried, carried_back
from gaitforge.motion.problem import Problem, kernel
from gaitforge.motion.trajectory import Discretisation, Trajectory, planar_motion, smooth_step


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
        grid, limbs = trajectory.grid, trajectory.robot.limbs
        moves = np.isin(grid.airborne[0], trajectory.moving)
        limb, k, lift, land = (each[moves] for each in grid.airborne)
        over = (k - lift) / (land - lift)
        up = smooth_step(1.0 - np.abs(2.0 * over - 1.0))
        goal = np.array([one.foot.radius for one in limbs])[limb] + 1.1 * trajectory.step_height * up
        weights = np.full(len(k), self.weight * grid.dt)
        feet = trajectory.foot_places
        here, before, after = (feet[limb, sample % grid.samples] for sample in (k, lift, land))
        height, path = kernel("swing_height", 1, 2, _height_instant), kernel("swing_path", 6, 8, _path_instant)
        problem.add_term(self.name, height, here[:, 2:], np.stack([weights, goal], axis=1))
        motions = _motions(grid)
        parameters = np.column_stack([weights, smooth_step(over), motions[k - lift], motions[land - k]])
        problem.add_term(self.name, path, np.hstack([before[:, :2], here[:, :2], after[:, :2]]), parameters)


def _motions(grid: Discretisation) -> NDArray[np.float64]:
    """(K + 1, 3) motion of the commanded frame over 0, 1, … intervals (none outside gaits)."""
    if not grid.cyclic:
        return np.zeros((grid.samples + 1, 3))
    return planar_motion(grid.command, np.arange(grid.samples + 1) * grid.dt)


def _height_instant(v: Any, p: Any) -> Any:
    return p[0] * (v[0] - p[1]) ** 2


def _path_instant(v: Any, p: Any) -> Any:
    import casadi as ca

    lift = carried_back(ca.vertcat(v[:2], 0), p[2:5])
    land = carried(ca.vertcat(v[4:6], 0), p[5:8])
    return p[0] * ca.sumsqr(v[2:4] - (1 - p[1]) * lift[:2] - p[1] * land[:2])
