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


def even_sets(k: int, m: int, cyclic: bool) -> Times:
    """(N, k) sets that are likely to serve: even spacing between any first and last time, with short gaps too."""
    if k < 2:
        return every_set(k, m, cyclic)
    spans = [(0, m, k)] if cyclic else [(a, b, k - 1) for a in range(1, m) for b in range(a + k - 1, m)]
    found = [_spaced(a, b, parts, gap) for a, b, parts in spans for gap in (None, 1, 2)]
    kept = [row[:k] for row in found if row is not None]
    return np.unique(np.array(kept, dtype=np.intp).reshape(-1, k), axis=0)


def _spaced(start: int, end: int, parts: int, gap: int | None) -> list[int] | None:
    """Ends of `parts` parts of [start, end], equal or every second one `gap` long; None when they do not fit."""
    if gap is None:
        return [start + (end - start) * p // parts for p in range(parts + 1)] if end - start >= parts else None
    long, short = (parts + 1) // 2, parts // 2
    room = end - start - short * gap
    if room < long:
        return None
    return [start + room * ((p + 1) // 2) // long + gap * (p // 2) for p in range(parts + 1)]


def necklaces(times: Times, m: int) -> Times:
    """Of the sets that begin at column 0 and differ by a rotation onto another of their times, one each."""
    k = times.shape[1]
    if k < 2:
        return times
    lengths = np.diff(times, axis=1, append=m)  # (N, k)
    weights = (m + 1) ** np.arange(k - 1, -1, -1, dtype=object)
    codes = np.stack([np.roll(lengths, -r, axis=1) @ weights for r in range(k)])
    return times[np.all(codes[0] <= codes, axis=0)]
