"""The gap rule: nothing lifts while something else lands."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gaitforge.footfall.constraints.base import ChangeConstraint, Contact, Violation, require_at_least, rows_of
from gaitforge.footfall.constraints.rules import ChangeRule
from gaitforge.footfall.problem import FootfallProblem


@dataclass(frozen=True)
class GapRule(ChangeConstraint):
    """No column boundary at which some foot lifts and another lands, the wrap of a cyclic gait included.

    With few limbs a swap leaves one shared support line at the switch, and the centre of pressure has to
    lie on it.  In force while at most `up_to` limbs are locomotive anywhere; 0 switches it off.
    """

    key: ClassVar[str] = "gap"
    title: ClassVar[str] = "gap between swings"
    equation: ClassVar[str] = "¬(C_aj ∧ ¬C_a,j+1 ∧ ¬C_bj ∧ C_b,j+1)  ∀ a ≠ b, j"
    relief: ClassVar[str] = "switch the gap rule off (gap.up_to = 0)"

    up_to: int = 4
    """[limbs]"""

    def __post_init__(self) -> None:
        require_at_least(self.key, "up_to", self.up_to, 0)

    def in_force(self, problem: FootfallProblem) -> bool:
        """Whether the rule holds for a problem with so many walking limbs."""
        return len(problem.locomotive_anywhere) <= self.up_to

    def rules(self, problem: FootfallProblem) -> tuple[ChangeRule, ...]:
        if not self.in_force(problem):
            return ()
        return (ChangeRule(rows_of(problem, problem.locomotive_anywhere)),)

    def violations(self, contact: Contact, problem: FootfallProblem) -> list[Violation]:
        if not self.in_force(problem):
            return []
        walking, m = rows_of(problem, problem.locomotive_anywhere), problem.columns
        found = []
        for j in range(m if problem.cyclic else m - 1):
            after = (j + 1) % m
            lifting = [i for i in walking if contact[i, j] and not contact[i, after]]
            landing = [i for i in walking if contact[i, after] and not contact[i, j]]
            if lifting and landing:
                names = [", ".join(problem.limbs[i] for i in group) for group in (lifting, landing)]
                text = f"{names[0]} lifts while {names[1]} lands after column {j}"
                found.append(self.violation(problem, lifting + landing, [j, after], text))
        return found
