"""What every solver returns, and what it has to offer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.problem import Problem
from gaitforge.motion.solvers.elastic import Violation

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Multipliers:
    """λ of L = f + λᵀ c at a solution; negative where a lower bound is active, positive at an upper one."""

    rows: Array
    """(row_count,)"""
    bounds: Array
    """(size,) of the variables' bounds, zero for constants"""


@dataclass(frozen=True, eq=False)
class Solution:
    """A point, and whether it is a good one."""

    x: Array
    """(size,) all variables of the problem, constants included"""
    solved: bool
    status: str
    iterations: int
    seconds: float
    """[s] building derivatives and solving"""
    cost: float
    residual: float
    """Largest violation of a row or bound."""
    worst: dict[str, tuple[float, Any, str]] = field(default_factory=dict)
    """Per family the largest violation, where, and its unit."""
    multipliers: Multipliers | None = None
    timings: Mapping[str, float] = field(default_factory=dict)
    """[s of processor] where the time went, by what was done"""
    violations: Sequence[Violation] | None = None
    """Of a failure: the rows that the least violated point violates, the worst first; None: not looked for"""


Start = Array | Solution | None
"""Where to begin: a full variable vector, or a solution of a similar problem, whose multipliers help too."""


class MotionSolver(Protocol):
    """`motion/solver=…`"""

    def solve(self, problem: Problem, start: Start = None) -> Solution:
        """Solve from `start` (the problem's own guess when None)."""
        ...
