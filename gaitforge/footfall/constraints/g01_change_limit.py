"""g1: how often a limb may change between swing and stance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gaitforge.footfall.constraints.base import Contact, LimbConstraint, Violation, require_at_least, rows_of
from gaitforge.footfall.constraints.rules import LimbRule
from gaitforge.footfall.problem import FootfallProblem


@dataclass(frozen=True)
class ChangeLimit(LimbConstraint):
    """Each limb changes at most `at_most` times; in a cyclic gait the wrap counts, so 2 is one swing per cycle."""

    key: ClassVar[str] = "g1"
    title: ClassVar[str] = "changes per limb"
    equation: ClassVar[str] = "Σ_j (C_ij − C_i,j+1)² ≤ 2  ∀ i"
    relief: ClassVar[str] = "allow more changes per limb (g1.at_most)"

    at_most: int = 2
    """[changes]"""

    def __post_init__(self) -> None:
        require_at_least(self.key, "at_most", self.at_most, 0)

    def rules(self, problem: FootfallProblem) -> tuple[LimbRule, ...]:
        walking = rows_of(problem, problem.locomotive_anywhere)
        return tuple(LimbRule(i, most_changes=self.at_most) for i in walking)

    def violations(self, contact: Contact, problem: FootfallProblem) -> list[Violation]:
        found = []
        for i in rows_of(problem, problem.locomotive_anywhere):
            changed = np.diff(contact[i].astype(int)) != 0
            columns: list[int] = np.flatnonzero(changed).tolist()
            if problem.cyclic and contact[i, 0] != contact[i, -1]:
                columns.append(problem.columns - 1)
            if len(columns) > self.at_most:
                found.append(self.violation(problem, [i], columns, f"{problem.limbs[i]} changes {len(columns)} times"))
        return found
