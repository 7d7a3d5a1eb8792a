"""The gait after one limb is lost: candidates like the gait before, those that the families allow, ranked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gaitforge.footfall.candidates import candidates_without
from gaitforge.footfall.constraints import ConstraintSet
from gaitforge.footfall.given import alternating
from gaitforge.footfall.model import check_pattern
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.footfall.problem import FootfallProblem
from gaitforge.footfall.ranking import Ranking, Travel, centroid_of, ranked

Left = tuple[tuple[str, str], ...]
"""(which, why)"""

SCREENED = 24
"""Judging margins costs n_F² m a pattern: only so many, by the centroid heuristic, are looked at that closely."""


def lost_limb(problem: FootfallProblem, original: FootfallPattern | None) -> tuple[FootfallPattern, str] | None:
    """(the gait before, its one limb that walks no more), or None when it is another reassignment.

    Without a gait before, or when it has other columns than the problem, it is the alternating gait of all limbs.
    """
    if original is None or not original.cyclic or original.columns != problem.columns:
        original = alternating(problem.limbs, problem.sides, problem.columns)
    before, after = set(original.locomotive), set(problem.locomotive_anywhere)
    lost = before - after
    return (original, lost.pop()) if len(lost) == 1 and after < before else None


def lost_limb_gaits(
    problem: FootfallProblem,
    families: Sequence[ConstraintSet],
    travel: Travel,
    original: FootfallPattern,
    lost: str,
    ranking: Ranking = "margin",
) -> tuple[list[FootfallPattern], Left]:
    """(candidates that satisfy every family, best first; which were left and why).

    Ranked by margin, those are left as well whose centre of mass cannot be kept over the feet at every switch.
    """

    def allowed(pattern: FootfallPattern) -> bool:
        return not check_pattern(pattern.contact, replace(problem, columns=pattern.columns), families)

    left = _left(problem, families, candidates_without(original, lost))
    found = candidates_without(original, lost, allowed)
    if problem.footholds is not None and len(found) > SCREENED:
        rest = sorted(found[1:], key=lambda p: centroid_of(p, problem) / p.columns)
        found = (found[0], *rest[: SCREENED - 1])
    best = list(ranked(found, problem, travel, ranking))
    if ranking == "margin" and problem.footholds is not None:
        tipping = [p for p in best if p.info["switch_margin_m"] <= 0.0]
        best = [p for p in best if p.info["switch_margin_m"] > 0.0]
        left += tuple((described(p), f"static margin {1000 * p.info['switch_margin_m']:.1f} mm") for p in tipping)
    return best, left


def _left(problem: FootfallProblem, families: Sequence[ConstraintSet], candidates: Sequence[FootfallPattern]) -> Left:
    """Candidates that break families, one entry for all that break the same."""
    groups: dict[tuple[str, ...], list[str]] = {}
    for pattern in candidates:
        broken = tuple(np.unique([v.family for v in check_pattern(pattern.contact, problem, families)]).tolist())
        if broken:
            groups.setdefault(broken, []).append(described(pattern))
    return tuple(
        (f"{len(names)} candidate patterns: {'; '.join(names)}", f"breaks {', '.join(broken)}")
        for broken, names in groups.items()
    )


def described(candidate: FootfallPattern) -> str:
    """A candidate in a few words: what was done to the original pattern."""
    operation, limbs, lost = (candidate.info[key] for key in ("operation", "limbs", "lost"))
    if operation == "original":
        return f"the original without {lost}"
    return f"{limbs[0]} and {limbs[1]} {operation}"
