"""g5: every limb that walks throughout takes a step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gaitforge.footfall.constraints.base import Contact, LimbConstraint, Violation, require_at_least, rows_of
from gaitforge.footfall.constraints.rules import LimbRule
from gaitforge.footfall.problem import FootfallProblem


@dataclass(frozen=True)
class SwingDuty(LimbConstraint):
    """Each limb that is locomotive throughout swings in at least `at_least` columns.

    A foot that never steps cannot reach its next foothold, so this is geometry, not taste.
    """

    key: ClassVar[str] = "g5"
    title: ClassVar[str] = "swing duty"
    equation: ClassVar[str] = "Σ_j C_ij ≤ m − 2  ∀ i"
    relief: ClassVar[str] = "lower the swing duty (g5.at_least)"

    at_least: int = 2
    """[columns]"""

    def __post_init__(self) -> None:
        require_at_least(self.key, "at_least", self.at_least, 0)

    def rules(self, problem: FootfallProblem) -> tuple[LimbRule, ...]:
        walking = rows_of(problem, problem.locomotive_throughout)
        return tuple(LimbRule(i, least_swing=self.at_least) for i in walking)

    def violations(self, contact: Contact, problem: FootfallProblem) -> list[Violation]:
        found = []
        for i in rows_of(problem, problem.locomotive_throughout):
            swing = int((~contact[i]).sum())
            if swing < self.at_least:
                text = f"{problem.limbs[i]} swings in {swing} of at least {self.at_least} columns"
                found.append(self.violation(problem, [i], range(problem.columns), text))
        return found
