"""What g6 and g7 share: no limb does much more of the work than another."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gaitforge.footfall.constraints.base import BalanceConstraint, Contact, Violation, require_at_least, rows_of
from gaitforge.footfall.constraints.rules import BalanceRule
from gaitforge.footfall.problem import FootfallProblem


@dataclass(frozen=True)
class Shared(BalanceConstraint):
    """Times in stance (swing) of limbs that are locomotive throughout differ by at most `at_most` columns.

    Over ordered pairs g6 and g7 are one sentence, so explanations know them as one family.
    """

    family: ClassVar[str] = "g6/g7"
    relief: ClassVar[str] = "let the limbs share the work less evenly (g6.at_most and g7.at_most)"
    stance: ClassVar[bool]
    """Whether the time in stance is compared, or that in swing."""

    at_most: int = 2
    """[columns]"""

    def __post_init__(self) -> None:
        require_at_least(self.key, "at_most", self.at_most, 0)

    def rules(self, problem: FootfallProblem) -> tuple[BalanceRule, ...]:
        return (BalanceRule(rows_of(problem, problem.locomotive_throughout), self.at_most),)

    def violations(self, contact: Contact, problem: FootfallProblem) -> list[Violation]:
        walking = list(rows_of(problem, problem.locomotive_throughout))
        columns = (contact[walking] == self.stance).sum(axis=1)
        if not walking or np.ptp(columns) <= self.at_most:
            return []
        most, least = int(columns.argmax()), int(columns.argmin())
        names, does = [problem.limbs[i] for i in walking], "stands" if self.stance else "swings"
        text = f"{names[most]} {does} for {columns[most]} columns, {names[least]} for {columns[least]} only"
        return [self.violation(problem, [walking[most], walking[least]], range(problem.columns), text)]
