"""Swinging feet near a smooth height profile."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.family import Family
from gaitforge.motion.problem import Problem, kernel
from gaitforge.motion.trajectory import Trajectory


@dataclass(frozen=True)
class SwingProfile(Family):
    """∫ w (e_z − r − 1.15 h sin(π s))² dt, s the share of the swing that is over."""

    name: ClassVar[str] = "swing"
    unit: ClassVar[str] = "m² s"
    weight: float = 100.0
    """per m² s"""
    step_height: float = 0.03
    """[m]"""

    def add_to(self, problem: Problem, trajectory: Trajectory) -> None:
        """One place a swing sample whose swing begins and ends on the ground."""
        grid, robot = trajectory.grid, trajectory.robot
        compiled = kernel("swing", 1, 2, _instant)
        for i in trajectory.moving:
            share = swing_share(grid.ground[:, i], grid.cyclic)
            here = np.flatnonzero(np.isfinite(share))
            goal = robot.limbs[i].foot.radius + 1.15 * self.step_height * np.sin(np.pi * share[here])
            parameters = np.stack([np.full(len(here), self.weight * grid.dt), goal], axis=1)
            problem.add_term(self.name, compiled, trajectory.feet[i][here, 2:3], parameters)


def swing_share(ground: NDArray[np.bool_], cyclic: bool) -> NDArray[np.float64]:
    """(K,) how much of its swing is over at each sample in the air; NaN on the ground or at open swings."""
    count = len(ground)
    share = np.full(count, np.nan)
    stands = np.flatnonzero(ground)
    if not len(stands):
        return share
    following = np.append(stands[1:], stands[0] + count) if cyclic else stands[1:]
    for a, b in zip(stands, following, strict=False):
        for k in range(int(a) + 1, int(b)):
            share[k % count] = (k - a) / (b - a)
    return share


def _instant(v: Any, p: Any) -> Any:
    return p[0] * (v[0] - p[1]) ** 2
