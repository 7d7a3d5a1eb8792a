"""What g9 and g10 share: some limb of one side of the body is in stance in every column."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gaitforge.footfall.constraints.base import ColumnConstraint, Contact, Violation, require_at_least, rows_of
from gaitforge.footfall.constraints.rules import StanceClause
from gaitforge.footfall.problem import FootfallProblem


@dataclass(frozen=True)
class SideStance(ColumnConstraint):
    """At least `at_least` limbs of a side in stance in every column; sides are true ones, from geometry.

    A robot that has no limb on that side at all is not asked.
    """

    side: ClassVar[str]

    at_least: int = 1
    """[limbs]"""

    def __post_init__(self) -> None:
        require_at_least(self.key, "at_least", self.at_least, 0)

    def rules(self, problem: FootfallProblem) -> tuple[StanceClause, ...]:
        if self.side not in problem.sides:
            return ()
        walking = rows_of(problem, problem.locomotive_anywhere)
        return (StanceClause(tuple(i for i in walking if problem.sides[i] == self.side), self.at_least),)

    def violations(self, contact: Contact, problem: FootfallProblem) -> list[Violation]:
        walking = set(problem.locomotive_anywhere)
        whole = [i for i, side in enumerate(problem.sides) if side == self.side]
        asked = [i for i in whole if problem.limbs[i] in walking]
        if not whole:
            return []
        standing = contact[asked].sum(axis=0)  # (m,)
        found = []
        for j, count in enumerate(standing):
            if count < self.at_least:
                text = f"{count} of at least {self.at_least} {self.side} limbs in stance in column {j}"
                found.append(self.violation(problem, asked, [j], text))
        return found
