"""Which columns of L are stored together: supernodes, their rows, and where entries of the matrix go."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.int32]
Longs = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Supernodes:
    """Panels of L: supernode s holds columns first[s] … first[s+1] − 1 over rows[rowptr[s] : rowptr[s+1]]."""

    order: Ints
    """(n,) permuted position → original index"""
    first: Ints
    rowptr: Ints
    rows: Ints
    start: Longs
    """Where each panel begins in the array of all panels"""
    owner: Ints
    """(n,) supernode of each column"""
    entry: Ints
    """Nonzeros of the matrix (upper triangle by columns) by supernode: entry[s] … entry[s+1] − 1 of the next two"""
    source: Ints
    """Which nonzero"""
    target: Ints
    """Where it goes in its supernode's panel"""

    @property
    def size(self) -> int:
        """Entries of all panels."""
        return int(self.start[-1])

    @property
    def widest(self) -> int:
        """Columns of the widest supernode."""
        return int(np.diff(self.first).max())

    @property
    def tallest(self) -> int:
        """Rows of the tallest panel."""
        return int(np.diff(self.rowptr).max())


def find_supernodes(indices: Ints, indptr: Ints, order: Ints, library: ctypes.CDLL) -> Supernodes:
    """From the pattern of the matrix and an ordering, by the compiled code of `symbolic.c`.

    Of the elimination tree's postorder, which fills in as much as `order` does, a column joins the one after it
    when that is its parent and few zeros are stored for it.
    """
    size, entries = len(indptr) - 1, len(indices)
    order, work = np.array(order, dtype=np.int32), np.zeros(8 * size + 10, dtype=np.int32)
    first, rowptr = np.zeros(size + 1, dtype=np.int32), np.zeros(size + 1, dtype=np.int32)
    source, target = np.zeros(entries, dtype=np.int32), np.zeros(entries, dtype=np.int32)
    given = (indptr, indices, order, first, rowptr)
    count = library.symbolic_supernodes(size, *map(pointer, (*given, work, source)))
    first, rowptr = first[: count + 1].copy(), rowptr[: count + 1].copy()
    rows, owner = np.zeros(rowptr[-1], dtype=np.int32), np.zeros(size, dtype=np.int32)
    entry = np.zeros(count + 1, dtype=np.int32)
    found = (rows, owner, entry, source, target)
    library.symbolic_rows(size, count, *map(pointer, (indptr, indices, order, first, rowptr, *found, work)))
    start = np.concatenate([[0], np.cumsum(np.diff(first).astype(np.int64) * np.diff(rowptr))])
    return Supernodes(order, first, rowptr, rows, start, *found[1:])


def pointer(array: Any) -> ctypes.c_void_p:
    """Where an array's numbers lie."""
    return ctypes.c_void_p(array.ctypes.data)
