"""g8: enough limbs in stance in every column."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gaitforge.footfall.constraints.base import ColumnConstraint, Contact, Violation, require_at_least, rows_of
from gaitforge.footfall.constraints.rules import StanceClause
from gaitforge.footfall.problem import FootfallProblem


@dataclass(frozen=True)
class StanceCount(ColumnConstraint):
    """At least `at_least` limbs in stance in every column, as the paper's text has it.

    The appendix prints Σ_i C_ij ≥ n_F − 3 (at most three in swing): `all_but` = 3, with n_F the limbs
    that are locomotive anywhere.
    """

    key: ClassVar[str] = "g8"
    title: ClassVar[str] = "limbs in stance"
    equation: ClassVar[str] = "Σ_i C_ij ≥ 3  ∀ j"
    relief: ClassVar[str] = "let more limbs walk"

    at_least: int = 3
    """[limbs]"""
    all_but: int | None = None
    """[limbs] when given it takes the place of `at_least`: all but so many are in stance"""

    def __post_init__(self) -> None:
        require_at_least(self.key, "at_least", self.at_least, 0)
        if self.all_but is not None:
            require_at_least(self.key, "all_but", self.all_but, 0)

    def demand(self, problem: FootfallProblem) -> int:
        """Number of limbs asked for in each column."""
        if self.all_but is None:
            return self.at_least
        return max(0, len(problem.locomotive_anywhere) - self.all_but)

    def rules(self, problem: FootfallProblem) -> tuple[StanceClause, ...]:
        return (StanceClause(rows_of(problem, problem.locomotive_anywhere), self.demand(problem)),)

    def violations(self, contact: Contact, problem: FootfallProblem) -> list[Violation]:
        walking = list(rows_of(problem, problem.locomotive_anywhere))
        demand, found = self.demand(problem), []
        for j in range(problem.columns):
            standing = sum(bool(contact[i, j]) for i in walking)
            if standing < demand:
                airborne = [i for i in walking if not contact[i, j]]
                text = f"{standing} of at least {demand} limbs in stance in column {j}"
                found.append(self.violation(problem, airborne, [j], text))
        return found
