"""What a solver of the general program answers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from gaitforge.footfall.program import Program

Status = Literal["optimal", "feasible", "infeasible", "unknown"]


@dataclass(frozen=True, eq=False)
class Solution:
    """Status, pattern and what it cost to find; *feasible* is a pattern without a proof that it is the best."""

    status: Status
    contact: NDArray[np.bool_] | None = None
    """(n_F, m) C, or None"""
    objective: int | None = None
    """Σ y of `contact`"""
    bound: int | None = None
    """Σ y is proven to be at least this."""
    build_s: float = 0.0
    """[s] handing the program over"""
    solve_s: float = 0.0
    """[s] in the solver"""

    @property
    def gap(self) -> float | None:
        """(Σ y − bound) / Σ y, 0 when the pattern is proven to be the best; None without pattern or bound."""
        if self.objective is None or self.bound is None:
            return None
        return (self.objective - self.bound) / max(1, self.objective)


@dataclass(frozen=True, eq=False)
class Listing:
    """Distinct patterns of one program with Σ y up to a ceiling."""

    contacts: tuple[NDArray[np.bool_], ...]
    complete: bool
    """True when there are no others."""
    solve_s: float = 0.0
    """[s]"""


class FootfallSolver(Protocol):
    """A backend for the general program."""

    @property
    def name(self) -> str:
        """For summaries."""
        ...

    def minimize(self, program: Program, time_limit_s: float, seed: int) -> Solution:
        """The pattern with the least Σ y, equation (2)."""
        ...

    def is_feasible(self, program: Program, time_limit_s: float, seed: int) -> bool | None:
        """Whether the program has a solution; None when time ran out before a proof."""
        ...

    def listing(self, program: Program, *, most_changes: int, limit: int, time_limit_s: float, seed: int) -> Listing:
        """Up to `limit` distinct patterns with Σ y ≤ `most_changes`."""
        ...
