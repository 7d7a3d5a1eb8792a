"""Phases of one row of C, read directly from the row: what the independent checks of g2–g4 look at."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Run:
    """One swing or stance phase."""

    stance: bool
    start: int
    """First column"""
    length: int
    """Number of columns"""
    whole: bool
    """False when an end of the pattern cuts it off, or when the limb never changes."""

    def columns(self, m: int) -> tuple[int, ...]:
        """The columns of the phase in a pattern of m."""
        return tuple((self.start + k) % m for k in range(self.length))


def runs_of(row: NDArray[np.bool_], cyclic: bool) -> list[Run]:
    """The phases of a row (m,) from its first column on; in a cyclic row a phase may go on past the seam."""
    cells: list[bool] = row.tolist()
    m = len(cells)
    starts = [j for j in range(m) if cells[j] != cells[j - 1] and (cyclic or j > 0)]
    if not starts:
        return [Run(cells[0], 0, m, False)]
    if cyclic:
        ends = [*starts[1:], starts[0] + m]
        return [Run(cells[s], s, e - s, True) for s, e in zip(starts, ends, strict=True)]
    edges = [0, *starts, m]
    return [Run(cells[s], s, e - s, s > 0 and e < m) for s, e in pairwise(edges)]
