"""Stance feet share the load."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from gaitforge.motion.family import Family
from gaitforge.motion.problem import Problem, kernel
from gaitforge.motion.trajectory import Trajectory


@dataclass(frozen=True)
class Sharing(Family):
    """∫ w Σ (w_i − 1/n)² dt: the CoP weights are not unique from four feet on."""

    name: ClassVar[str] = "sharing"
    unit: ClassVar[str] = "s"
    weight: float = 0.02

    def add_to(self, problem: Problem, trajectory: Trajectory) -> None:
        """One place a CoP weight."""
        seconds = trajectory.grid.dt * self.weight
        index = np.concatenate([w for _, _, w in trajectory.weights])[:, None]
        share = np.concatenate([np.full(len(w), 1.0 / len(w)) for _, _, w in trajectory.weights])
        parameters = np.stack([np.full(len(share), seconds), share], axis=1)
        problem.add_term(self.name, kernel("sharing", 1, 2, _instant), index, parameters)


def _instant(v: Any, p: Any) -> Any:
    return p[0] * (v[0] - p[1]) ** 2
