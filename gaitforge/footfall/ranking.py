"""Patterns in the order in which they are worth handing to the motion optimiser."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitforge.footfall.margin import Stability, stability
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.footfall.placement import stance_offsets
from gaitforge.footfall.problem import FootfallProblem
from gaitforge.footfall.seam import airborne

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Travel:
    """How the body moves while a pattern runs."""

    per_column: Array
    """(2,) [m] in the body frame"""
    ends: tuple[Array, Array] | None = None
    """In a transition: (n_F,) offsets of the feet from their footholds at both ends [columns of travel]."""


SWAY = 0.15
"""How far the body may be shifted, as a part of the mean distance from the centre of mass to the footholds."""


def stability_of(pattern: FootfallPattern, problem: FootfallProblem, travel: Travel) -> Stability:
    """Margins and centroid heuristic of a pattern over the problem's footholds; needs `problem.footholds`."""
    assert problem.footholds is not None
    holds = problem.footholds
    offsets = stance_offsets(pattern, travel.ends)  # (n_F, m, 2)
    feet = holds[:, None, None, :] + offsets[..., None] * travel.per_column
    walking = [problem.limbs.index(n) for n in problem.locomotive_anywhere]
    sway = SWAY * float(np.linalg.norm(holds[walking] - problem.center_of_mass, axis=1).mean())
    return stability(pattern.contact, feet, problem.center_of_mass, sway, pattern.cyclic)


def ranked(
    patterns: Iterable[FootfallPattern], problem: FootfallProblem, travel: Travel
) -> tuple[FootfallPattern, ...]:
    """Best first; each pattern's `info` gets margin_m, switch_margin_m and centroid_m.

    A gait is judged by the margin that one shift of the body gives, a transition by its switches (there the
    body is on its way anyhow); equal ones by the other margin, the number of changes and the centroid.
    A gait during which some foot is always in the air comes after those that can be started from a stand.
    Without footholds the order is that of Σ y alone.
    """
    patterns = list(patterns)
    if problem.footholds is None:
        return tuple(sorted(patterns, key=lambda p: p.changes))
    judged = []
    for pattern in patterns:
        s = stability_of(pattern, problem, travel)
        measures = {"margin_m": s.margin, "switch_margin_m": s.switch_margin, "centroid_m": s.centroid}
        judged.append((_order(pattern, s), replace(pattern, info={**pattern.info, **measures})))
    return tuple(pattern for _, pattern in sorted(judged, key=lambda item: item[0]))


def _order(pattern: FootfallPattern, s: Stability) -> tuple[float, ...]:
    in_air = int(airborne(pattern.contact).min()) if pattern.cyclic else 0
    margins = (s.margin, s.switch_margin) if pattern.cyclic else (s.switch_margin, s.margin)
    millimetres = [-round(1e3 * value) for value in margins]
    return (in_air, *millimetres, pattern.changes, round(s.centroid, 6))


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
