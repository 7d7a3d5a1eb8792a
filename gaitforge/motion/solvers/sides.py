"""All finite bounds of a problem, on variables and on rows, as one vector of one-sided inequalities."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.problem import Problem
from gaitforge.motion.solvers.solution import Multipliers
from gaitforge.motion.solvers.structure import Structure

Array = NDArray[np.float64]
Index = NDArray[np.intp]


class Sides:
    """sign · c − bound ≥ 0, where c stacks the free variables x and the rows g(x); equal rows stand apart."""

    def __init__(self, problem: Problem, structure: Structure) -> None:
        low, high = (bound[structure.free] for bound in problem.bounds)
        row_low, row_high = problem.row_bounds
        same = row_low == row_high
        self.equal: Index = np.flatnonzero(same)
        """Rows with lower = upper"""
        self.loose: Index = np.flatnonzero(~same)
        """Rows with room"""
        self.target: Array = row_low[self.equal]
        lower = np.concatenate([low, np.where(same, -np.inf, row_low)])
        upper = np.concatenate([high, np.where(same, np.inf, row_high)])
        below, above = np.flatnonzero(np.isfinite(lower)), np.flatnonzero(np.isfinite(upper))
        self.at: Index = np.concatenate([below, above])
        """Which entry of c a side bounds"""
        self.sign: Array = np.concatenate([np.ones(len(below)), -np.ones(len(above))])
        self.bound: Array = np.concatenate([lower[below], -upper[above]])
        self._count = len(lower)
        self._free = structure.free

    def __len__(self) -> int:
        return len(self.at)

    def gap(self, x: Array, rows: Array) -> Array:
        """(sides,) how far each is from its bound; negative: violated."""
        return np.asarray(self.sign * np.concatenate([x, rows])[self.at] - self.bound)

    def along(self, dx: Array, rows: Array) -> Array:
        """(sides,) change of the gaps when x and the rows change by this."""
        return np.asarray(self.sign * np.concatenate([dx, rows])[self.at])

    def add(self, values: Array) -> Array:
        """(variables + rows,) sum of a quantity of the sides at what they bound."""
        return np.asarray(np.bincount(self.at, values, self._count), dtype=float)

    def from_multipliers(self, multipliers: Multipliers, rows: int) -> Array:
        """(sides,) the part of each side in net multipliers; rows that a former problem lacked get zero."""
        known = np.zeros(rows)
        known[: len(multipliers.rows)] = multipliers.rows[:rows]
        net = np.concatenate([multipliers.bounds[self._free], known])
        return np.asarray(np.maximum(0.0, -self.sign * net[self.at]))
