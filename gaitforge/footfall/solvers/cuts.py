"""Listing patterns with a solver that gives one at a time: each one found is cut off."""

from __future__ import annotations

import copy
import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from gaitforge.footfall.program import Program
from gaitforge.footfall.solvers.base import Listing, Solution

Search = Callable[[Program, float], Solution]
"""A search for any pattern of a program within a time [s]."""


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
