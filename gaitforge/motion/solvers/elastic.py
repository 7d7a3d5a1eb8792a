"""The point that violates a motion problem least: which rows have no room, and by how much.

    minimise f(x) + Σ ρ (s⁺ + s⁻)   subject to   l ≤ c(x) + s⁺ − s⁻ ≤ u,   s⁺, s⁻ ≥ 0

An ℓ₁ price leaves few rows violated (Chinneck & Dravnieks 1991; the elastic mode of SNOPT): those that
are in the way of all others.  Where none is left, the point is a start from which the problem is solved.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.problem import Problem, Rows, kernel

Array = NDArray[np.float64]
DEFINITIONS = ("center_of_mass",)
"""Rows that define a variable rather than ask for something"""
PRICE = {"m": 1e3, "rad": 2e2, "m²": 5e3, "1": 2e2}
"""ρ per unit: about one for what is noticed, a millimetre or a third of a degree"""
DEARER = {"rolling": 5.0}
"""Families that give way last: any motion becomes possible where feet may slip, which explains nothing"""
NOTICED = 0.3
"""Price from which on a violation is told"""


@dataclass(frozen=True)
class Violation:
    """One row that is in the way."""

    family: str
    label: Any
    component: int
    """Which of the rows with this label"""
    amount: float
    """By how much the row's value has to be moved; negative: it is too large"""
    unit: str


@dataclass(frozen=True, eq=False)
class Elastic:
    """A problem whose rows may be violated, at a price."""

    problem: Problem
    """Variables of the original problem first, slacks after them"""
    slack: NDArray[np.intp]
    """(rows, 2) indices of s⁺, s⁻"""
    blocks: list[Rows]
    """The original rows, in the order of `slack`"""

    def violations(self, x: Array) -> list[Violation]:
        """The rows that a point of the relaxed problem still violates, the worst priced first."""
        pulled = x[self.slack]
        amounts = pulled[:, 0] - pulled[:, 1]
        found, at = [], 0
        for block in self.blocks:
            count = len(block.lower)
            for row in np.flatnonzero(np.abs(amounts[at : at + count]) * _price(block) > NOTICED):
                label, amount = block.labels[row], float(amounts[at + row])
                violation = Violation(block.family, label, _component(block, int(row)), amount, block.unit)
                found.append((violation, _price(block) * abs(amount)))
            at += count
        return [violation for violation, _ in sorted(found, key=lambda item: -item[1])]


def _price(block: Rows) -> float:
    return PRICE.get(block.unit, PRICE["1"]) * DEARER.get(block.family, 1.0)


def _component(block: Rows, row: int) -> int:
    """Rows with the same label stand together."""
    first = row
    while first and block.labels[first - 1] is block.labels[row]:
        first -= 1
    return row - first


def relax(problem: Problem) -> Elastic:
    """The relaxed problem; its slacks begin at what the starting point lacks."""
    relaxed = replace(
        problem, guess=list(problem.guess), lower=list(problem.lower), upper=list(problem.upper),
        rows=list(problem.rows), terms=list(problem.terms),
    )  # fmt: skip
    blocks = [block for block in problem.rows if block.family not in DEFINITIONS]
    if not blocks:
        return Elastic(relaxed, np.zeros((0, 2), dtype=np.intp), [])
    rows = np.concatenate([np.arange(b.start, b.start + len(b.lower)) for b in blocks])
    price = np.concatenate([np.full(len(b.lower), _price(b)) for b in blocks])
    short = _shortfall(problem, blocks)
    start = np.stack([np.maximum(short, 0.0), np.maximum(-short, 0.0)], axis=1) + 1e-4
    slack = relaxed.add_variables(start, 0.0, np.inf)
    relaxed.add_term("elastic", kernel("elastic", 2, 0, lambda v, p: v[0] - v[1]), slack, np.zeros(0), rows[:, None])
    relaxed.add_term("elastic", kernel("elastic_price", 2, 1, lambda v, p: p[0] * (v[0] + v[1])), slack, price[:, None])
    return Elastic(relaxed, slack, blocks)


def _shortfall(problem: Problem, blocks: list[Rows]) -> Array:
    """What the rows of the starting point lack (> 0) or have too much (< 0)."""
    low, high = problem.bounds
    values = problem.constraint_values(np.clip(problem.x0, low, high))
    parts = [values[b.start : b.start + len(b.lower)] for b in blocks]
    return np.concatenate(
        [
            np.maximum(b.lower - part, 0.0) - np.maximum(part - b.upper, 0.0)
            for b, part in zip(blocks, parts, strict=True)
        ]
    )
