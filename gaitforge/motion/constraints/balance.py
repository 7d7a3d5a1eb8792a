"""The centre of pressure of the inverted pendulum stays in the polygon of the feet that hold the interval."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from gaitforge.motion.family import Family, carried, carried_back
from gaitforge.motion.problem import Problem, kernel
from gaitforge.motion.trajectory import Trajectory, WeightSet
from gaitforge.robot.gravity import GRAVITY


@dataclass(frozen=True)
class Balance(Family):
    """CoP = x − z / (g + z̈) ẍ = Σ w e / Σ w with w ≥ w_min, at both ends of every interval.

    Written without the quotient, whose pole at z̈ = −g throws an optimiser off: Σ w = 1 + z̈/g and
    Σ w e = (1 + z̈/g) x − z ẍ / g, so that m g w_i is the vertical force on foot i.
    w ≥ s/n for n stance feet keeps the CoP inside the support polygon shrunk towards its centroid
    by the share s / (1 + z̈/g); where contacts change there are two sets of weights at one sample.
    """

    name: ClassVar[str] = "balance"
    unit: ClassVar[str] = "m"
    enforced: ClassVar[str] = "at samples, for the feet of the interval before and of the one after"

    def add_to(self, problem: Problem, trajectory: Trajectory) -> None:
        """Three rows a sample and contact set: x and y of the CoP, and the sum of the weights."""
        grid = trajectory.grid
        sets = self._sets(trajectory)
        names = trajectory.robot.limb_names
        labels = [("+".join(names[i] for i in feet), k) for k, feet, _ in sets]
        rows = problem.add_rows(self.name, 0.0, 0.0, (len(sets), 3), self.unit, labels)
        at = np.array([k for k, _, _ in sets])
        before, after = grid.neighbours(at)
        com = trajectory.com
        variables = np.hstack([com[before], com[at], com[after]])
        parameters = self._parameters(trajectory)[at]
        problem.add_term(self.name, kernel("cop", 9, 9, _cop_instant), variables, parameters, rows)
        one = np.repeat(np.arange(len(sets)), [len(feet) for _, feet, _ in sets])
        limbs = np.concatenate([feet for _, feet, _ in sets])
        weights = np.concatenate([index for _, _, index in sets])
        places = np.column_stack([weights, trajectory.foot_places[limbs, at[one], :2]])
        problem.add_term(self.name, kernel("weight", 3, 0, _weight_instant), places, np.zeros(0), rows[one])

    def _sets(self, trajectory: Trajectory) -> Sequence[WeightSet]:
        """The samples and contact sets that are balanced."""
        return trajectory.weights

    @staticmethod
    def _parameters(trajectory: Trajectory) -> np.ndarray:
        """(K, 9) coefficients of the three samples, what end velocities add, motion of the frame."""
        grid = trajectory.grid
        start = grid.start.com_velocity if grid.start is not None else np.zeros(3)
        end = grid.end.com_velocity if grid.end is not None else np.zeros(3)
        return np.hstack([*grid.accelerations(start, end), np.tile(grid.step, (grid.samples, 1))])


def _cop_instant(v: Any, p: Any) -> Any:
    import casadi as ca

    before, now, after = carried_back(v[:3], p[6:9]), v[3:6], carried(v[6:9], p[6:9])
    acceleration = p[0] * before + p[1] * now + p[2] * after + p[3:6]
    lift = 1 + acceleration[2] / GRAVITY
    return ca.vertcat(lift * now[:2] - now[2] * acceleration[:2] / GRAVITY, -lift)


def _weight_instant(v: Any, p: Any) -> Any:
    import casadi as ca

    return ca.vertcat(-v[0] * v[1], -v[0] * v[2], v[0])
