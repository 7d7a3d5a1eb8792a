"""The body ends where it is told to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from gaitforge.motion.family import Family
from gaitforge.motion.problem import Problem, kernel
from gaitforge.motion.trajectory import Trajectory


@dataclass(frozen=True)
class Placed(Family):
    """b_N = pose: where a stand ends is otherwise left to its costs."""

    name: ClassVar[str] = "placed"
    unit: ClassVar[str] = "m, rad"
    enforced: ClassVar[str] = "at the last sample of an open segment"
    pose: tuple[float, float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    """x, y, z [m], roll, pitch, yaw [rad] of base_link in the segment's frame"""

    def add_to(self, problem: Problem, trajectory: Trajectory) -> None:
        """Six rows; none in a gait."""
        if trajectory.grid.cyclic:
            return
        pose = np.array(self.pose)
        rows = problem.add_rows(self.name, pose, pose, (1, 6), self.unit, ["end"])
        problem.add_term(self.name, kernel("placed", 6, 0, _instant), trajectory.base[-1:], np.zeros(0), rows)


def _instant(v: Any, p: Any) -> Any:
    return v
