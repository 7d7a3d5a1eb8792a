"""Wave gaits whose order is chosen by margin."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import permutations

from gaitforge.footfall.given import wave
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.footfall.problem import FootfallProblem
from gaitforge.footfall.ranking import Travel, ranked

ALL_ORDERS = 5
"""Up to so many limbs every order is tried: (n − 1)! of them."""


def best_wave(problem: FootfallProblem, travel: Travel, swing_columns: int) -> FootfallPattern:
    """The wave over the walking limbs with the best margin; one all-stance column after each swing.

    A wave keeps the time of a column, and so its travel, not that of a cycle.
    """
    waves = [wave(order, problem.limbs, swing_columns) for order in _orders(problem)]
    longer = replace(problem, columns=waves[0].columns)
    return ranked(waves, longer, travel)[0]


def swing_columns_for(columns: int, limbs: int) -> int:
    """Swing columns of a wave of about `columns`: one of each limb's columns is all-stance, two or more are swing."""
    return max(2, columns // max(1, limbs) - 1)


def _orders(problem: FootfallProblem) -> Iterator[tuple[str, ...]]:
    """Orders of the walking limbs, up to rotation: all of them for few limbs, else the metachronal ones."""
    walking = problem.locomotive_anywhere
    if len(walking) <= ALL_ORDERS:
        for rest in permutations(walking[1:]):
            yield (walking[0], *rest)
        return
    side = dict(zip(problem.limbs, problem.sides, strict=True))
    left = [n for n in reversed(walking) if side[n] != "right"]  # rear to front
    right = [n for n in reversed(walking) if side[n] == "right"]
    yield (*right, *left)
    yield (*right[::-1], *left[::-1])
    for shift in range(max(1, len(left))):
        turned = left[shift:] + left[:shift]
        mixed = [n for pair in zip(right, turned, strict=False) for n in pair]
        yield (*mixed, *(n for n in [*right, *turned] if n not in mixed))
