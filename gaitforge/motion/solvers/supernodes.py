"""Which columns of L are stored together: supernodes, their rows, and where entries of the matrix go."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.int32]
Longs = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Supernodes:
    """Panels of L: supernode s holds columns first[s] … first[s+1] − 1 over rows[rowptr[s] : rowptr[s+1]]."""

    order: NDArray[np.intp]
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
    widest: int
    """Columns of the widest supernode"""
    tallest: int
    """Rows of the tallest panel"""

    @property
    def size(self) -> int:
        """Entries of all panels."""
        return int(self.start[-1])


def find_supernodes(
    indices: Ints, indptr: Ints, order: NDArray[np.intp], lower_indices: Ints, lower_indptr: Ints
) -> Supernodes:
    """From the matrix' pattern, an ordering, and the pattern of L strictly below its diagonal in that order.

    A column joins the one after it when that is its parent in the elimination tree and few zeros are stored for it.
    """
    size = len(indptr) - 1
    counts = np.diff(lower_indptr)
    columns = [np.sort(lower_indices[lower_indptr[j] : lower_indptr[j + 1]]) for j in range(size)]
    first, zeros = [0], 0
    for j in range(1, size):
        child = columns[j - 1]
        width = j - first[-1]
        extra = width * (counts[j] + 1 - counts[j - 1]) if len(child) and child[0] == j else -1
        full = (width + 1) * (counts[j] + 1 + width / 2)
        if extra >= 0 and (zeros + extra) <= _allowed(width + 1) * full:
            zeros += extra
        else:
            first.append(j)
            zeros = 0
    first.append(size)
    begins = np.array(first, dtype=np.int32)
    rows = [np.concatenate([np.arange(a, b), columns[b - 1]]) for a, b in pairwise(first)]
    heights, widths = np.array([len(r) for r in rows]), np.diff(begins)
    rowptr = np.concatenate([[0], np.cumsum(heights)])
    start = np.concatenate([[0], np.cumsum(heights * widths)])
    owner = np.repeat(np.arange(len(widths)), widths)
    return Supernodes(
        order=order,
        first=begins,
        rowptr=rowptr.astype(np.int32),
        rows=np.concatenate(rows).astype(np.int32),
        start=start.astype(np.int64),
        owner=owner.astype(np.int32),
        **_entries(indices, indptr, order, begins, rows, heights, owner),
        widest=int(widths.max()),
        tallest=int(heights.max()),
    )


def _allowed(width: int) -> float:
    """Share of stored zeros that a supernode may have: narrow ones gain most from being joined."""
    return 0.6 if width <= 4 else 0.3 if width <= 16 else 0.1


def _entries(
    indices: Ints,
    indptr: Ints,
    order: NDArray[np.intp],
    first: Ints,
    rows: list[NDArray[np.intp]],
    heights: NDArray[np.intp],
    owner: NDArray[np.intp],
) -> dict[str, Ints]:
    place = np.empty(len(order), dtype=np.intp)
    place[order] = np.arange(len(order))
    a = place[indices]
    b = place[np.repeat(np.arange(len(indptr) - 1), np.diff(indptr))]
    row, column = np.maximum(a, b), np.minimum(a, b)
    node = owner[column]
    source = np.argsort(node, kind="stable")
    entry = np.searchsorted(node[source], np.arange(len(rows) + 1))
    row, column, node = row[source], column[source], node[source]
    target = (column - first[node]) * heights[node]
    for own, begin, end in zip(rows, entry[:-1], entry[1:], strict=True):
        target[begin:end] += np.searchsorted(own, row[begin:end])
    return {"entry": entry.astype(np.int32), "source": source.astype(np.int32), "target": target.astype(np.int32)}
