"""Sets of change times, as rows of one array."""

from __future__ import annotations

from itertools import chain, combinations
from math import comb

import numpy as np
from numpy.typing import NDArray

Times = NDArray[np.intp]


def number_of_sets(k: int, m: int, cyclic: bool) -> int:
    """How many sets of k change times there are; in a gait the first is column 0."""
    if cyclic:
        return 1 if k == 0 else comb(m - 1, k - 1)
    return comb(m - 1, k)


def every_set(k: int, m: int, cyclic: bool) -> Times:
    """(N, k) all sets of k change times, in lexicographic order."""
    if k == 0:
        return np.zeros((1, 0), dtype=np.intp)
    inner = k - 1 if cyclic else k
    count = comb(m - 1, inner) * inner
    flat = np.fromiter(chain.from_iterable(combinations(range(1, m), inner)), dtype=np.intp, count=count)
    found = flat.reshape(-1, inner) if inner else np.zeros((1, 0), dtype=np.intp)
    return np.concatenate([np.zeros((len(found), 1), dtype=np.intp), found], axis=1) if cyclic else found


def even_sets(k: int, m: int, cyclic: bool, gaps: bool) -> Times:
    """(N, k) sets that are likely to serve: even spacing between any first and last time.

    With `gaps` also those in which every second part lasts one or two columns.
    """
    if k < 2:
        return every_set(k, m, cyclic)
    if cyclic:
        first, last, parts = np.array([0]), np.array([m]), k
    else:
        first, last = np.triu_indices(m - 1, k - 1)
        first, last, parts = first + 1, last + 1, k - 1
    found = [_spaced(first, last, parts, gap) for gap in ((None, 1, 2) if gaps else (None,))]
    return np.concatenate(found)[:, :k]


def _spaced(start: Times, end: Times, parts: int, gap: int | None) -> Times:
    """(N', parts + 1) ends of the parts of [start, end], equal or every second one `gap` long; those that fit."""
    part = np.arange(parts + 1)
    long, share = (parts, part) if gap is None else ((parts + 1) // 2, (part + 1) // 2)
    short = np.zeros_like(part) if gap is None else gap * (part // 2)
    room = end - start - short[-1]
    fits = room >= long
    found: Times = start[fits, None] + room[fits, None] * share // long + short
    return found


def necklaces(times: Times, m: int) -> Times:
    """Of the sets that begin at column 0 and differ by a rotation onto another of their times, one each."""
    k = times.shape[1]
    if k < 2:
        return times
    lengths = np.diff(times, axis=1, append=m)  # (N, k)
    weights = (m + 1) ** np.arange(k - 1, -1, -1, dtype=object)
    codes = np.stack([np.roll(lengths, -r, axis=1) @ weights for r in range(k)])
    return times[np.all(codes[0] <= codes, axis=0)]


def symmetric(times: Times, m: int) -> NDArray[np.bool_]:
    """(N,) whether a rotation by less than a cycle maps a set that begins at column 0 onto itself."""
    lengths = np.diff(times, axis=1, append=m)  # (N, k)
    found = np.zeros(len(times), dtype=bool)
    for r in range(1, times.shape[1]):
        found |= (np.roll(lengths, -r, axis=1) == lengths).all(axis=1)
    return found
