"""Instances of the footfall benchmark."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitforge.footfall.constraints import ConstraintSet, StanceCount, default_constraints, with_problem_families
from gaitforge.footfall.constraints.g11_support_sectors import SupportSectors
from gaitforge.footfall.problem import FootfallProblem

MARGIN = 0.1
"""[m] δ of g11"""


@dataclass(frozen=True, eq=False)
class Case:
    """A problem with its families."""

    name: str
    problem: FootfallProblem
    families: tuple[ConstraintSet, ...]

    def with_rows_in(self, order: NDArray[np.intp]) -> Case:
        """The same instance with its limbs in another order."""
        p = self.problem
        turned = replace(
            p,
            limbs=tuple(p.limbs[i] for i in order),
            sides=tuple(p.sides[i] for i in order),
            first=None if p.first is None else p.first[order],
            last=None if p.last is None else p.last[order],
            footholds=None if p.footholds is None else p.footholds[order],
        )
        return replace(self, problem=turned)


def families(g11: bool = False, printed_g8: bool = False, gap: bool = False) -> tuple[ConstraintSet, ...]:
    """g1–g10, with the appendix's g8, g11 and the gap rule where asked for."""
    chosen = [f for f in default_constraints() if gap or f.key != "gap"]
    chosen = [StanceCount(all_but=3) if printed_g8 and f.key == "g8" else f for f in chosen]
    return with_problem_families([*chosen, SupportSectors(delta=MARGIN)] if g11 else chosen)


def robot(limbs: int) -> dict[str, object]:
    """Names, sides and footholds: two rows of feet at ±0.28 m spaced 0.12 m, 48 limbs at ±0.30 m spaced 0.10 m."""
    half_width, spacing = (0.30, 0.10) if limbs >= 48 else (0.28, 0.12)
    half = limbs // 2
    x = spacing * ((half - 1) / 2 - np.arange(half))
    rows = [np.stack([x, np.full(half, y)], axis=1) for y in (half_width, -half_width)]
    return {
        "limbs": tuple(f"{side}{i}" for side in "LR" for i in range(1, half + 1)),
        "sides": ("left",) * half + ("right",) * half,
        "footholds": np.concatenate(rows),
    }


def gait(limbs: int, columns: int, lost: tuple[str, ...] = ()) -> FootfallProblem:
    """A cyclic problem."""
    body = robot(limbs)
    walking = tuple(n for n in body["limbs"] if n not in lost)  # type: ignore[attr-defined]
    return FootfallProblem(columns=columns, cyclic=True, locomotive_before=walking, locomotive_after=walking, **body)


def transition(first: str, last: str, columns: int) -> FootfallProblem:
    """A transition between two columns written as "0110…", rows L1 … Ln, R1 … Rn."""
    body = robot(len(first))
    ends = {key: np.array([c == "1" for c in column]) for key, column in (("first", first), ("last", last))}
    names = body["limbs"]
    return FootfallProblem(
        columns=columns, cyclic=False, locomotive_before=names, locomotive_after=names, **ends, **body
    )


def transitions() -> list[Case]:
    """The paper's two sizes, and what g11, the printed g8 and 48 limbs make of them."""
    six = transition("010101", "011011", 11)
    twelve = transition("011111111110", "011011110111", 18)
    return [
        Case("6 × 11", six, families()),
        Case("12 × 18", twelve, families()),
        Case("12 × 18 with g11", twelve, families(g11=True)),
        Case("12 × 18, printed g8", twelve, families(printed_g8=True)),
    ]


def gaits() -> list[Case]:
    """Cyclic programs of the hexapod and the dodecapod."""
    return [
        Case("6 × 12, none free", gait(6, 12), families()),
        Case("6 × 12, one free", gait(6, 12, ("L1",)), families()),
        Case("6 × 12, two free", gait(6, 12, ("L1", "R1")), families()),
        Case("6 × 12, two free, gap rule", gait(6, 12, ("L1", "R1")), families(gap=True)),
        Case("12 × 20 with g11", gait(12, 20), families(g11=True)),
    ]


def growing() -> list[tuple[int, int, bool, Case]]:
    """(n_F, m, with g11, transition from stance to stance)"""
    return [
        (n, m, g11, Case(f"{n} × {m}" + " with g11" * g11, transition("1" * n, "1" * n, m), families(g11=g11)))
        for n in (4, 6, 8, 12, 24, 48)
        for m in (10, 20, 40)
        for g11 in (False, True)
    ]
