"""g7: no limb swings much longer than another."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gaitforge.footfall.constraints.base import BalanceConstraint, Contact, Violation, require_at_least, rows_of
from gaitforge.footfall.constraints.rules import BalanceRule
from gaitforge.footfall.problem import FootfallProblem


@dataclass(frozen=True)
class SharedSwing(BalanceConstraint):
    """No limb that is locomotive throughout swings more than `at_most` columns longer than another.

    Over ordered pairs g6 and g7 are one sentence, so explanations know them as one family.
    """

    key: ClassVar[str] = "g7"
    title: ClassVar[str] = "swing shared"
    equation: ClassVar[str] = "−Σ_j C_aj + Σ_j C_bj ≤ 2  ∀ a ≠ b"
    family: ClassVar[str] = "g6/g7"
    relief: ClassVar[str] = "let the limbs share the work less evenly (g6.at_most and g7.at_most)"

    at_most: int = 2
    """[columns]"""

    def __post_init__(self) -> None:
        require_at_least(self.key, "at_most", self.at_most, 0)

    def rules(self, problem: FootfallProblem) -> tuple[BalanceRule, ...]:
        return (BalanceRule(rows_of(problem, problem.locomotive_throughout), self.at_most),)

    def violations(self, contact: Contact, problem: FootfallProblem) -> list[Violation]:
        walking = np.array(rows_of(problem, problem.locomotive_throughout), dtype=int)
        swing = (~contact[walking]).sum(axis=1)
        excess = swing[:, None] - swing[None, :] > self.at_most
        found = []
        for a, b in np.argwhere(excess):
            text = f"{problem.limbs[walking[a]]} swings {swing[a]} columns, {problem.limbs[walking[b]]} only {swing[b]}"
            found.append(self.violation(problem, [walking[a], walking[b]], range(problem.columns), text))
        return found
