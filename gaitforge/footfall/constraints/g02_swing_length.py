"""g2: how long a swing phase lasts at least."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gaitforge.footfall.constraints.base import Contact, LimbConstraint, Violation, require_at_least, rows_of
from gaitforge.footfall.constraints.rules import LimbRule
from gaitforge.footfall.constraints.runs import runs_of
from gaitforge.footfall.problem import FootfallProblem


@dataclass(frozen=True)
class SwingLength(LimbConstraint):
    """Each swing phase lasts `at_least` columns; phases cut off by an end of a transition are exempt."""

    key: ClassVar[str] = "g2"
    title: ClassVar[str] = "length of a swing phase"
    equation: ClassVar[str] = "C_ij − C_i,j+1 + C_i,j+2 ≤ 1  ∀ i, j"
    relief: ClassVar[str] = "allow shorter swing phases (g2.at_least)"

    at_least: int = 2
    """[columns]"""

    def __post_init__(self) -> None:
        require_at_least(self.key, "at_least", self.at_least, 1)

    def rules(self, problem: FootfallProblem) -> tuple[LimbRule, ...]:
        too_short = tuple(range(1, self.at_least))
        walking = rows_of(problem, problem.locomotive_anywhere)
        return tuple(LimbRule(i, forbidden_swing_runs=too_short) for i in walking)

    def violations(self, contact: Contact, problem: FootfallProblem) -> list[Violation]:
        found = []
        for i in rows_of(problem, problem.locomotive_anywhere):
            for run in runs_of(contact[i], problem.cyclic):
                if run.whole and not run.stance and 1 <= run.length < self.at_least:
                    text = f"{problem.limbs[i]} swings for {run.length} of at least {self.at_least} columns"
                    found.append(self.violation(problem, [i], run.columns(problem.columns), text))
        return found
