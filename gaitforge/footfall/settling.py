"""Feet put down elsewhere one after the other while the body stands: from one stand to another."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from gaitforge.footfall.margin import support_margins
from gaitforge.footfall.pattern import FootfallPattern

Array = NDArray[np.float64]
SWAY_M = 0.06
"""[m] that the body may be beside its place while a foot is in the air"""
SWING, STANCE, LIFT = 2, 1, 4
"""Columns of a step, of the stand after it, and in which the body is lifted off held feet at the end"""
MOST = 5
"""Limbs whose steps are taken one by one; all their orders are tried."""


def settling_patterns(
    limbs: Sequence[str],
    walking: Sequence[str],
    held: Sequence[str],
    feet: tuple[Array, Array],
    centers: tuple[Array, Array],
    limit: int = 3,
) -> tuple[FootfallPattern, ...]:
    """One step of each walking limb, in the orders with the best static margins, best first.

    `feet`: footholds (n_F, 2) before and after [m], seen from the body; `centers`: centre of mass (2,) before and
    after [m].  `held` limbs stand where they are and bear load until the last columns, and with them the body
    cannot sway.  Orders that leave the centre of mass outside the polygon of the feet come last.
    """
    names, order = list(limbs), list(walking)
    moving = [names.index(n) for n in order]
    stays = [names.index(n) for n in held]
    line = np.linspace(-SWAY_M, SWAY_M, 7)
    sway = np.stack(np.meshgrid(line, line, indexing="ij"), axis=-1).reshape(-1, 2)
    middle = 0.5 * (centers[0] + centers[1])
    points = np.array([centers[0]]) if stays else middle + sway
    ranked = []
    for steps in permutations(moving):
        places, stance = _stages(steps, stays, feet, len(names))
        margins = support_margins(places, stance, points).max(axis=1)
        ranked.append((-float(margins.min()), -float(margins.mean()), steps))
    ranked.sort()
    return tuple(_pattern(names, steps, stays, -least) for least, _, steps in ranked[:limit])


def _stages(
    steps: Sequence[int], stays: Sequence[int], feet: tuple[Array, Array], count: int
) -> tuple[Array, NDArray[np.bool_]]:
    """(k, n_F, 2) where the feet are, and (k, n_F) which of them stand, during each step."""
    places, stance = np.tile(feet[0], (len(steps), 1, 1)), np.zeros((len(steps), count), dtype=bool)
    stance[:, [*steps, *stays]] = True
    for k, i in enumerate(steps):
        stance[k, i] = False
        places[k + 1 :, i] = feet[1][i]
    return places, stance


def _pattern(names: list[str], steps: Sequence[int], stays: Sequence[int], margin: float) -> FootfallPattern:
    each = SWING + STANCE
    columns = STANCE + len(steps) * each + (LIFT if stays else 0)
    contact = np.zeros((len(names), columns), dtype=bool)
    contact[list(steps)] = True
    contact[list(stays), : columns - LIFT] = True
    for k, i in enumerate(steps):
        first = STANCE + k * each
        contact[i, first : first + SWING] = False
    info = {"name": "settling", "order": tuple(names[i] for i in steps), "margin_m": margin}
    return FootfallPattern(contact, tuple(names), cyclic=False, source="wave", info=info)
