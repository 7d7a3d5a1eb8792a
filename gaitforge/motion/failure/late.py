"""Balance from some moment on: before it a body tips, because too few feet are on the ground."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from gaitforge.motion.constraints.balance import Balance
from gaitforge.motion.trajectory import Trajectory, WeightSet


@dataclass(frozen=True)
class LateBalance(Balance):
    """`Balance` after a sample: feet that are put down by then land where they hold the body."""

    enforced: ClassVar[str] = "at later samples, for the feet of the interval before and of the one after"

    since: int = 0
    """The last sample without balance"""

    def _sets(self, trajectory: Trajectory) -> Sequence[WeightSet]:
        return [one for one in trajectory.weights if one[0] > self.since]
