"""g11: the centre of mass stays inside the support polygon, with a margin, in every column."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from gaitforge.errors import InputError, Problem
from gaitforge.footfall.constraints.base import ColumnConstraint, Contact, Violation, rows_of
from gaitforge.footfall.constraints.rules import StanceClause
from gaitforge.footfall.margin import support_margins
from gaitforge.footfall.problem import FootfallProblem

Array = NDArray[np.float64]

SAME_ANGLE = 1e-9
"""[rad] angles closer than this are one: what lies between them is rounding"""
TOUCH = 1e-9
"""[m] a margin so little short of δ is rounding"""


@dataclass(frozen=True)
class SupportSectors(ColumnConstraint):
    """The support polygon contains the disc of radius `delta` about the centre of mass p, in every column.

    The disc is inside exactly when for every unit n some stance foot f_j has n·(f_j − p) ≥ δ.  The limbs that
    can serve, S(n), change only at the angles a_j ± arccos(δ / |f_j − p|), so one n in each arc between
    neighbouring angles is enough; of the sets found those that hold no smaller one are the clauses: at
    most 2 n_F.  Exact for the footholds and the centre of mass of the problem; where the feet are while the
    body moves on over them, `placement` and the ranking look at.
    """

    key: ClassVar[str] = "g11"
    title: ClassVar[str] = "centre of mass inside the support polygon"
    equation: ClassVar[str] = "Σ_{i ∈ S(n)} C_ij ≥ 1  ∀ n, j;  S(n) = {i : n·(f_i − p) ≥ δ}"
    relief: ClassVar[str] = "ask for less margin (g11.delta), or let more limbs walk"
    who: ClassVar[str] = "limbs on one side of the centre of mass"

    delta: float = 0.02
    """[m]"""
    fallback: tuple[float, ...] = (0.01, 0.005)
    """[m] margins asked for where there is no pattern with `delta`, those below it, largest first; see `placement`"""

    def __post_init__(self) -> None:
        object.__setattr__(self, "fallback", tuple(self.fallback))
        wrong: list[tuple[str, object]] = [("delta", self.delta)] if not _is_length(self.delta) else []
        if not all(_is_length(step) for step in self.fallback):
            wrong.append(("fallback", self.fallback))
        if wrong:
            raise InputError(
                Problem("footfall/constraints", f"{self.key}.{name}", repr(value), "lengths > 0 [m]")
                for name, value in wrong
            )

    @property
    def margins(self) -> tuple[float, ...]:
        """`delta` and the smaller ones to fall back on, largest first [m]."""
        return (self.delta, *sorted({step for step in self.fallback if step < self.delta}, reverse=True))

    def rules(self, problem: FootfallProblem) -> tuple[StanceClause, ...]:
        feet, walking = footholds_of(problem), rows_of(problem, problem.locomotive_anywhere)
        sectors = support_sectors(feet[list(walking)] - problem.center_of_mass, self.delta)
        return tuple(StanceClause(tuple(walking[k] for k in sector), 1) for sector in sectors)

    def violations(self, contact: Contact, problem: FootfallProblem) -> list[Violation]:
        walking = list(rows_of(problem, problem.locomotive_anywhere))
        margins = column_margins(contact[walking], footholds_of(problem)[walking], problem.center_of_mass)
        found = []
        for j in np.flatnonzero(margins < self.delta - TOUCH).tolist():
            airborne = [i for i in walking if not contact[i, j]]
            text = f"margin of {1000 * margins[j]:.1f} mm, not {1000 * self.delta:g} mm, in column {j}"
            found.append(self.violation(problem, airborne, [j], text))
        return found


def support_sectors(arms: Array, delta: float) -> tuple[tuple[int, ...], ...]:
    """The minimal sets S(n) of feet at `arms` (n, 2) from the centre of mass [m]; an empty one where none serves."""
    reach = np.hypot(*arms.T) if len(arms) else np.zeros(0)
    far = reach >= delta
    angle = np.arctan2(arms[far, 1], arms[far, 0])
    half = np.arccos(delta / reach[far])
    edges = np.sort(np.concatenate([angle - half, angle + half]) % (2 * np.pi))
    if not len(edges):
        return ((),)
    following = np.append(edges[1:], edges[0] + 2 * np.pi)
    middle = (edges + following)[following - edges > SAME_ANGLE] / 2
    normals = np.stack([np.cos(middle), np.sin(middle)])
    serving = arms @ normals >= delta  # (n, arcs)
    sets = sorted({frozenset(np.flatnonzero(column).tolist()) for column in serving.T}, key=lambda s: (len(s), *s))
    minimal: list[frozenset[int]] = []
    for candidate in sets:
        if not any(smaller <= candidate for smaller in minimal):
            minimal.append(candidate)
    return tuple(tuple(sorted(s)) for s in minimal)


def column_margins(contact: Contact, feet: Array, center_of_mass: Array) -> Array:
    """(m,) distance of the centre of mass from the edge of each column's support polygon, positive inside [m].

    `contact` (n, m), `feet` (n, 2); the hull is found from the feet themselves, without any sectors.
    """
    places = np.broadcast_to(feet, (contact.shape[1], *feet.shape))
    return support_margins(places, contact.T, np.asarray(center_of_mass, dtype=float)[None])[:, 0]


def footholds_of(problem: FootfallProblem) -> Array:
    """(n_F, 2) the problem's footholds; InputError when it has none, or none for each limb."""
    shape = (len(problem.limbs), 2)
    if problem.footholds is None or np.shape(problem.footholds) != shape or not np.isfinite(problem.footholds).all():
        found = "none" if problem.footholds is None else f"{np.shape(problem.footholds)}"
        raise InputError(Problem("footfall", "footholds", found, f"finite positions {shape} [m], which g11 needs"))
    return np.asarray(problem.footholds, dtype=float)


def _is_length(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and 0 < value < np.inf
