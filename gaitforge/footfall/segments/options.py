"""Masks of segments: what one limb may do between k change times."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Options:
    """All rows with changes at given times only, for k times.

    In this order: swing from time a to time b; stance from time a to time b; stance throughout; in a gait
    also swing throughout (in a transition that is swing from the first to the last end).  In a transition
    times are numbered 0 … k + 1 with the ends t_0 = 0 and t_k+1 = m, in a gait 0 … k − 1.
    """

    times: int
    """k"""
    cyclic: bool
    swing_from: NDArray[np.intp]
    swing_to: NDArray[np.intp]
    stance_from: NDArray[np.intp]
    stance_to: NDArray[np.intp]
    segments: int
    """k + 1, in a gait k (1 when nothing changes)"""
    masks: tuple[int, ...]
    """Segments in swing, as bits, per option."""
    lifts: tuple[int, ...]
    """Times at which the limb lifts, as bits, per option."""
    lands: tuple[int, ...]
    stance: NDArray[np.bool_]
    """(O, segments) which segments are in stance"""
    within: tuple[int, ...]
    """Options, as bits, whose mask is a proper part of this one's."""

    @property
    def count(self) -> int:
        """Number of options."""
        return len(self.masks)


@lru_cache(maxsize=64)
def options_for(times: int, cyclic: bool) -> Options:
    """The options for k times."""
    swinging, standing = _pairs(times, cyclic)
    segments = max(times, 1) if cyclic else times + 1
    whole = (1 << segments) - 1
    described = [_swing(a, b, times, cyclic) for a, b in swinging]
    described += [(whole & ~_between(a, b), 1 << (b - 1), 1 << (a - 1)) for a, b in standing]
    described += [(0, 0, 0)] + [(whole, 0, 0)] * cyclic
    masks = tuple(mask for mask, _, _ in described)
    within = tuple(sum(1 << o for o, p in enumerate(masks) if p & ~q == 0 and p != q) for q in masks)
    stance = np.array([[not mask >> s & 1 for s in range(segments)] for mask in masks])
    lifts, lands = tuple(up for _, up, _ in described), tuple(down for _, _, down in described)
    ends = _column(swinging, 0), _column(swinging, 1), _column(standing, 0), _column(standing, 1)
    return Options(times, cyclic, *ends, segments, masks, lifts, lands, stance, within)


def _column(pairs: list[tuple[int, int]], side: int) -> NDArray[np.intp]:
    return np.array([pair[side] for pair in pairs], dtype=np.intp)


def _pairs(times: int, cyclic: bool) -> tuple[list[tuple[int, int]], list[tuple[int, int]]]:
    if cyclic:
        return [(a, b) for a in range(times) for b in range(times) if a != b], []
    swing = [(a, b) for a in range(times + 1) for b in range(a + 1, times + 2)]
    return swing, [(a, b) for a in range(1, times) for b in range(a + 1, times + 1)]


def _between(a: int, b: int) -> int:
    """Segments a … b − 1 as bits."""
    return (1 << b) - (1 << a)


def _swing(a: int, b: int, times: int, cyclic: bool) -> tuple[int, int, int]:
    """Mask, lifts and lands of swing from time a to time b; the ends of a transition are no changes."""
    if cyclic:
        mask = _between(a, b) if a < b else ((1 << times) - 1) & ~_between(b, a)
        return mask, 1 << a, 1 << b
    return _between(a, b), (1 << (a - 1)) if a > 0 else 0, (1 << (b - 1)) if b <= times else 0
