"""Patterns in the order in which they are worth handing to the motion optimiser."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from gaitforge.footfall.heuristic import centroid_heuristic
from gaitforge.footfall.margin import Stability, stability
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.footfall.placement import stance_offsets, step_rate
from gaitforge.footfall.problem import FootfallProblem
from gaitforge.footfall.seam import airborne

Array = NDArray[np.float64]
Ranking = Literal["margin", "centroid"]
RANKINGS: tuple[Ranking, ...] = ("margin", "centroid")


@dataclass(frozen=True, eq=False)
class Travel:
    """How the body moves while a pattern runs."""

    per_column: Array
    """(2,) [m] in the body frame"""
    ends: tuple[Array, Array] | None = None
    """In a transition: (n_F,) offsets of the feet from their footholds at both ends [columns of travel]."""


SWAY = 0.15
"""How far the body may be shifted, as a part of the mean distance from the centre of mass to the footholds."""


AMPLE = 0.03
"""[m] margin beyond which more is no better"""
GRAIN = 0.002
"""[m] margins closer than this are alike"""
UNHURRIED = 5.0
"""Mean speed of a foot in swing, in units of the body's speed: that of a four-limbed wave of 2 + 1 columns."""


def stability_of(pattern: FootfallPattern, problem: FootfallProblem, travel: Travel, offsets: Array) -> Stability:
    """Margins of a pattern with these `stance_offsets` over the problem's footholds; needs `problem.footholds`."""
    assert problem.footholds is not None
    holds = problem.footholds
    feet = holds[:, None, None, :] + offsets[..., None] * travel.per_column
    walking = [problem.limbs.index(n) for n in problem.locomotive_anywhere]
    sway = SWAY * float(np.linalg.norm(holds[walking] - problem.center_of_mass, axis=1).mean())
    return stability(pattern.contact, feet, problem.center_of_mass, sway, pattern.cyclic)


def ranked(
    patterns: Iterable[FootfallPattern], problem: FootfallProblem, travel: Travel, by: Ranking = "margin"
) -> tuple[FootfallPattern, ...]:
    """Best first; each pattern's `info` gets margin_m, switch_margin_m, centroid_m, step_rate and ranked_by.

    *margin*, in this order: a gait that can be started from a stand before one with always some foot in the
    air; no step in a hurry (`step_rate` up to `UNHURRIED`); margin, up to `AMPLE`, of which more does not help:
    of a gait the one that one shift of the body gives, of a transition the one at its switches, since there the
    body is on its way anyhow; fewer changes; what walks already before what was changed; slower steps; the
    centroid.  *centroid* is the heuristic of section III-B.1, here the mean over the columns, so that patterns
    of different length compare; equals by margin.  Without footholds: Σ y alone.
    """
    patterns = list(patterns)
    if problem.footholds is None:
        return tuple(sorted(patterns, key=lambda p: p.changes))
    measured = [judged(pattern, problem, travel, by) for pattern in patterns]
    return tuple(pattern for _, pattern in sorted(measured, key=lambda item: item[0]))


def judged(
    pattern: FootfallPattern, problem: FootfallProblem, travel: Travel, by: Ranking
) -> tuple[tuple[float, ...], FootfallPattern]:
    """(sort key, smaller is better; the pattern with what was measured); needs `problem.footholds`."""
    offsets = stance_offsets(pattern, travel.ends)  # (n_F, m, 2)
    s = stability_of(pattern, problem, travel, offsets)
    rate = step_rate(pattern, offsets, travel.ends)
    centroid = centroid_of(pattern, problem)
    measures = {"margin_m": s.margin, "switch_margin_m": s.switch_margin, "centroid_m": centroid, "step_rate": rate}
    order = _order(pattern, s, rate, centroid / pattern.columns)
    if by == "centroid":
        order = (round(centroid / pattern.columns, 6), *order)
    return order, replace(pattern, info={**pattern.info, **measures, "ranked_by": by})


def centroid_of(pattern: FootfallPattern, problem: FootfallProblem) -> float:
    """[m] the heuristic of section III-B.1, each foot at its foothold, its mean stance position."""
    assert problem.footholds is not None
    return centroid_heuristic(pattern.contact, problem.footholds, problem.center_of_mass)


def _order(pattern: FootfallPattern, s: Stability, rate: float, centroid: float) -> tuple[float, ...]:
    in_air = int(airborne(pattern.contact).min()) if pattern.cyclic else 0
    hurry = round(2 * max(0.0, rate - UNHURRIED)) / 2
    margins = (s.margin, s.switch_margin) if pattern.cyclic else (s.switch_margin, s.margin)
    steps = [-round(min(value, AMPLE) / GRAIN) for value in margins]
    changed = pattern.info.get("operation") != "original"
    return (in_air, hurry, *steps, pattern.changes, changed, round(rate, 2), round(centroid, 6))


def diverse(patterns: Sequence[FootfallPattern], limit: int, apart: int = 4) -> tuple[FootfallPattern, ...]:
    """The first `limit` that differ by `apart` cells from those before them, filled up in order when too few do."""
    chosen: list[int] = []
    for k, pattern in enumerate(patterns):
        if len(chosen) == limit:
            break
        if all(_distance(pattern, patterns[c]) >= apart for c in chosen):
            chosen.append(k)
    rest = [k for k in range(len(patterns)) if k not in chosen]
    return tuple(patterns[k] for k in sorted(chosen + rest[: max(0, limit - len(chosen))]))


def _distance(a: FootfallPattern, b: FootfallPattern) -> int:
    return int((a.contact != b.contact).sum()) if a.contact.shape == b.contact.shape else a.contact.size
