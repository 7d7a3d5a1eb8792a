"""Where a robot that handles loads is to be at the ends of a segment: what it picks up stands somewhere."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from gaitforge.motion.family import Family
from gaitforge.motion.problem import Problem, kernel
from gaitforge.motion.trajectory import Trajectory


@dataclass(frozen=True)
class Arrival(Family):
    """p_N − p_0 = 0 in the plane: the base ends where it began, however it sways in between."""

    name: ClassVar[str] = "arrival"
    unit: ClassVar[str] = "m"
    enforced: ClassVar[str] = "between the ends of an open segment"

    def add_to(self, problem: Problem, trajectory: Trajectory) -> None:
        """Two rows."""
        rows = problem.add_rows(self.name, 0.0, 0.0, (1, 2), self.unit, ["end"])
        ends = np.concatenate([trajectory.base[0, :2], trajectory.base[-1, :2]])
        problem.add_term(self.name, kernel("arrival", 4, 0, _difference), ends, np.zeros(0), rows)


@dataclass(frozen=True)
class Facing(Family):
    """yaw = 0 at rest, in the frame of the gait that is begun or ended there: the robot looks where it walks.

    A gait yaws to and fro; a stand that begins in the middle of that would turn the whole walk by it.
    """

    name: ClassVar[str] = "facing"
    unit: ClassVar[str] = "rad"
    enforced: ClassVar[str] = "at an end at rest"

    def add_to(self, problem: Problem, trajectory: Trajectory) -> None:
        """One row an end at rest; none in a gait or between gaits."""
        grid = trajectory.grid
        for at, end in ((0, grid.start), (-1, grid.end)):
            if end is not None and end.rest:
                rows = problem.add_rows(self.name, 0.0, 0.0, (1, 1), self.unit, ["start" if at == 0 else "end"])
                problem.add_term(self.name, kernel("facing", 1, 0, _itself), trajectory.base[at, 5:], np.zeros(0), rows)


def _difference(v: Any, p: Any) -> Any:
    return v[2:] - v[:2]


def _itself(v: Any, p: Any) -> Any:
    return v
