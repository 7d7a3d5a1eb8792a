"""g6: no limb stands much longer than another."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gaitforge.footfall.constraints.base import BalanceConstraint, Contact, Violation, require_at_least, rows_of
from gaitforge.footfall.constraints.rules import BalanceRule
from gaitforge.footfall.problem import FootfallProblem


@dataclass(frozen=True)
class SharedStance(BalanceConstraint):
    """No limb that is locomotive throughout stands more than `at_most` columns longer than another.

    Over ordered pairs g6 and g7 are one sentence, so explanations know them as one family.
    """

    key: ClassVar[str] = "g6"
    title: ClassVar[str] = "stance shared"
    equation: ClassVar[str] = "Σ_j C_aj − Σ_j C_bj ≤ 2  ∀ a ≠ b"
    family: ClassVar[str] = "g6/g7"
    relief: ClassVar[str] = "let the limbs share the work less evenly (g6.at_most and g7.at_most)"

    at_most: int = 2
    """[columns]"""

    def __post_init__(self) -> None:
        require_at_least(self.key, "at_most", self.at_most, 0)

    def rules(self, problem: FootfallProblem) -> tuple[BalanceRule, ...]:
        return (BalanceRule(rows_of(problem, problem.locomotive_throughout), self.at_most),)

    def violations(self, contact: Contact, problem: FootfallProblem) -> list[Violation]:
        walking = rows_of(problem, problem.locomotive_throughout)
        if not walking:
            return []
        stance = {i: int(contact[i].sum()) for i in walking}
        most, least = max(stance, key=stance.__getitem__), min(stance, key=stance.__getitem__)
        if stance[most] - stance[least] <= self.at_most:
            return []
        names = problem.limbs
        text = f"{names[most]} stands {stance[most]} columns, {names[least]} only {stance[least]}"
        return [self.violation(problem, [most, least], range(problem.columns), text)]
