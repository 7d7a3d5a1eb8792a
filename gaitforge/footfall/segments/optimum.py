"""The least number of change times, or the proof that there is no pattern."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitforge.footfall.segments.bound import least_times
from gaitforge.footfall.segments.masks import availabilities
from gaitforge.footfall.segments.options import Options, options_for
from gaitforge.footfall.segments.placing import Effort, Placer, TooHard, limb_order
from gaitforge.footfall.segments.reading import LimbType, Reading
from gaitforge.footfall.segments.rows import Rows, rows_of_type
from gaitforge.footfall.segments.times import Times, even_sets, every_set, number_of_sets

FEW = 300
"""Sets of times that are all looked at at once, without trying even spacing first."""
FEW_WITH_GAPS = 50
"""The same under the gap rule, where each set costs more."""
REMEMBERED = 50
"""Failed sets of options that are kept to recognise others by: placing is cheaper than a long list."""


@dataclass(frozen=True, eq=False)
class Optimum:
    """A pattern with the least Σ y, the proof that there is none (neither, and `proven`), or neither of the two."""

    contact: NDArray[np.bool_] | None
    """(n_F, m)"""
    bound: int
    """Σ y is proven to be at least this."""
    proven: bool


def kinds_of(reading: Reading) -> tuple[list[tuple[LimbType, Rows]], list[int]]:
    """The distinct types with their rows, and per limb the index of its own."""
    types = list(dict.fromkeys(reading.types))
    rows = [(t, rows_of_type(t, reading.columns, reading.cyclic)) for t in types]
    index = {t: k for k, t in enumerate(types)}
    return rows, [index[t] for t in reading.types]


def optimum(reading: Reading, largest: int, effort: int) -> Optimum:
    """The pattern with the fewest change times.

    `largest`: most sets of times looked at for one number of times; `effort`: most limbs tried with a mask.
    Beyond either it gives up, with the bound reached.
    """
    kinds, kind = kinds_of(reading)
    bound = least_times(reading, [kinds[t][1] for t in kind])
    if bound is None:
        return Optimum(None, 0, True)
    order, budget = limb_order(reading), Effort(effort)
    most = min(2 * len(kind), reading.columns if reading.cyclic else reading.columns - 1)
    for k in range(bound, most + 1):
        if reading.cyclic and k == 1:
            continue
        placer = Placer(reading, kind, options_for(k, reading.cyclic), order, budget)
        try:
            for times in _stages(reading, k, largest):
                contact = _first_fit(reading, kinds, placer, times)
                if contact is not None:
                    return Optimum(contact, k, True)
        except TooHard:
            return Optimum(None, k, False)
        if number_of_sets(k, reading.columns, reading.cyclic) > largest:
            return Optimum(None, k, False)
    return Optimum(None, most + 1, True)


def _stages(reading: Reading, k: int, largest: int) -> Iterator[Times]:
    """Sets of times in the order of trying: all at once when they are few, else evenly spaced ones first."""
    count = number_of_sets(k, reading.columns, reading.cyclic)
    gaps = any(t.gapped for t in reading.types)
    if count > (FEW_WITH_GAPS if gaps else FEW):
        yield even_sets(k, reading.columns, reading.cyclic, gaps)
    if count <= largest:
        yield every_set(k, reading.columns, reading.cyclic)


def _first_fit(
    reading: Reading, kinds: Sequence[tuple[LimbType, Rows]], placer: Placer, times: Times
) -> NDArray[np.bool_] | None:
    failed: deque[tuple[int, ...]] = deque(maxlen=REMEMBERED)
    for found in availabilities(reading, kinds, placer.options, times):
        if any(all(b & ~f == 0 for b, f in zip(found.options, fail, strict=True)) for fail in failed):
            continue
        placed = placer.place(found.options)
        if placed is not None:
            return contact_of(placed, placer.options, times[found.times], reading.columns)
        failed.appendleft(found.options)
    return None


def contact_of(placed: Sequence[int], options: Options, times: NDArray[np.intp], m: int) -> NDArray[np.bool_]:
    """(n_F, m) C of one option per limb at the times (k,)."""
    edges = np.concatenate([[0] if not options.cyclic or not len(times) else [], times, [m]]).astype(np.intp)
    return np.repeat(options.stance[list(placed)], np.diff(edges), axis=1)
