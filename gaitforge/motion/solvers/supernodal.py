"""LDLᵀ in dense panels, by the compiled code of `ldl.c`."""

from __future__ import annotations

import ctypes

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.solvers.supernodes import Supernodes, pointer

Array = NDArray[np.float64]
BEYOND = 16
"""Entries behind the last panel that the compiled code may read (TALL)"""
WIDE = 8
"""Most columns of a tile"""


class Supernodal:
    """A factorisation of one pattern, whose supernodes are known."""

    def __init__(self, nodes: Supernodes, library: ctypes.CDLL) -> None:
        self._library, self._nodes = library, nodes
        size, count = len(nodes.order), len(nodes.first) - 1
        panels, self._vector = np.zeros(nodes.size + BEYOND), np.zeros(size)
        pivots, packed, tallest = np.zeros(size), np.zeros(WIDE * nodes.widest), np.zeros(nodes.tallest)
        integers = [np.zeros(n, dtype=np.int32) for n in (count, count, count, size, size)]
        self._values = np.zeros(len(nodes.source))
        shared = [nodes.first, nodes.rowptr, nodes.rows, nodes.start, panels, pivots]
        entries = [nodes.entry, nodes.source, nodes.target, self._values]
        self._kept = (shared, integers, packed, tallest)
        self._factor = [count, *map(pointer, [*shared, *entries, *integers, nodes.owner, packed])]
        self._solve = [count, *map(pointer, [*shared, self._vector, tallest])]

    def factor(self, values: Array) -> int | None:
        """Factor K with these nonzeros (upper triangle by columns); its number of negative pivots, None on failure."""
        self._values[:] = values
        negative = int(self._library.ldl_factor(*self._factor))
        return negative if negative >= 0 else None

    def solve(self, right: Array) -> Array:
        """K⁻¹ right, for the values factored last."""
        np.take(right, self._nodes.order, out=self._vector)
        self._library.ldl_solve(*self._solve)
        solution = np.empty_like(self._vector)
        solution[self._nodes.order] = self._vector
        return solution
