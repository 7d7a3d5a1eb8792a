"""Solvers that give one pattern at a time; listed are several by cutting off each one found."""

from __future__ import annotations

import copy
import time
from abc import ABC, abstractmethod
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from gaitforge.footfall.program import Program
from gaitforge.footfall.solvers.base import Listing, Solution

Search = Callable[[Program, float], Solution]
"""A search for any pattern of a program within a time [s]."""


class OneAtATime(ABC):
    """A backend that answers every question about a program by one kind of search."""

    def minimize(self, program: Program, time_limit_s: float, seed: int) -> Solution:
        """The pattern with the least Σ y; interrupted, or out of time, the best one so far with its bound."""
        return self._search(program, time_limit_s, seed, minimize=True)

    def is_feasible(self, program: Program, time_limit_s: float, seed: int) -> bool | None:
        """Whether the program has a solution; None when time ran out before a proof."""
        status = self._search(program, time_limit_s, seed, minimize=False).status
        return {"optimal": True, "feasible": True, "infeasible": False, "unknown": None}[status]

    def listing(self, program: Program, *, most_changes: int, limit: int, time_limit_s: float, seed: int) -> Listing:
        """Up to `limit` distinct patterns with Σ y ≤ `most_changes`, one search for each."""

        def search(left: Program, seconds: float) -> Solution:
            return self._search(left, seconds, seed, minimize=False)

        return listing_by_cuts(program, search, most_changes, limit, time_limit_s)

    @abstractmethod
    def _search(self, program: Program, time_limit_s: float, seed: int, minimize: bool) -> Solution:
        """The best pattern within the time, or without `minimize` any one."""


def listing_by_cuts(program: Program, search: Search, most_changes: int, limit: int, time_limit_s: float) -> Listing:
    """Up to `limit` distinct patterns with Σ y ≤ `most_changes`, one solve for each."""
    start = time.perf_counter()
    left = copy.copy(program)
    left.rows = list(program.rows)
    left.row([(y, 1) for y in program.objective], None, most_changes, "listing")
    found: list[NDArray[np.bool_]] = []
    complete = False
    while len(found) < limit and time.perf_counter() - start < time_limit_s:
        solution = search(left, time_limit_s - (time.perf_counter() - start))
        if solution.contact is None:
            complete = solution.status == "infeasible"
            break
        found.append(solution.contact)
        cells = solution.contact.ravel()
        left.clause(np.flatnonzero(~cells).tolist(), np.flatnonzero(cells).tolist(), "listing")
    return Listing(tuple(found), complete, time.perf_counter() - start)
