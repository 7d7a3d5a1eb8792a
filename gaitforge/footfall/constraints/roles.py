"""What the roles of the limbs say about their rows; part of every problem."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gaitforge.footfall.constraints.base import Contact, LimbConstraint, Violation, require_at_least
from gaitforge.footfall.constraints.rules import LimbRule
from gaitforge.footfall.problem import FootfallProblem


@dataclass(frozen=True)
class Roles(LimbConstraint):
    """Nonlocomotive limbs swing throughout; in a gait a locomotive limb has a stance phase as well.

    In a transition a limb that walks only afterwards swings in the first `columns` columns (there it comes
    from its posture), one that walked only before swings in the last `columns` (there it goes to its own).
    """

    key: ClassVar[str] = "roles"
    title: ClassVar[str] = "roles of the limbs"
    equation: ClassVar[str] = "C_ij = 0 while limb i is nonlocomotive;  Σ_j C_ij ≥ 1 in a gait"
    relief: ClassVar[str] = "change the roles"

    columns: int = 2
    """[columns]"""

    def __post_init__(self) -> None:
        require_at_least(self.key, "columns", self.columns, 0)

    def rules(self, problem: FootfallProblem) -> tuple[LimbRule, ...]:
        return tuple(self._rule(problem, i) for i in range(len(problem.limbs)))

    def _rule(self, problem: FootfallProblem, i: int) -> LimbRule:
        m, name = problem.columns, problem.limbs[i]
        before, after = name in problem.locomotive_before, name in problem.locomotive_after
        if not before and not after:
            return LimbRule(i, swing_in=tuple(range(m)))
        if before and after:
            return LimbRule(i, least_stance=1 if problem.cyclic else 0)
        kept = min(self.columns, m)
        return LimbRule(i, swing_in=tuple(range(kept)) if after else tuple(range(m - kept, m)))

    def violations(self, contact: Contact, problem: FootfallProblem) -> list[Violation]:
        anywhere, throughout = set(problem.locomotive_anywhere), set(problem.locomotive_throughout)
        found = []
        for i, name in enumerate(problem.limbs):
            stance = [int(j) for j in contact[i].nonzero()[0]]
            if name not in anywhere and stance:
                found.append(self.violation(problem, [i], stance, f"{name} does not walk, yet stands"))
            elif name in throughout and problem.cyclic and not stance:
                found.append(self.violation(problem, [i], (), f"{name} walks, yet never stands"))
            elif name in anywhere - throughout:
                starts = name in problem.locomotive_after
                wrong = [j for j in stance if (j < self.columns if starts else j >= problem.columns - self.columns)]
                if wrong:
                    found.append(self.violation(problem, [i], wrong, f"{name} stands while it changes its role"))
        return found


@dataclass(frozen=True)
class Boundary(LimbConstraint):
    """The first and last column of a transition are those that the gaits on either side ask for."""

    key: ClassVar[str] = "boundary"
    title: ClassVar[str] = "boundary columns"
    equation: ClassVar[str] = "C_i0 = first_i,  C_i,m−1 = last_i  ∀ i"
    relief: ClassVar[str] = "leave or enter the gaits at another column (from_column, to_column)"

    def rules(self, problem: FootfallProblem) -> tuple[LimbRule, ...]:
        m, rules = problem.columns, []
        for column, wanted in ((0, problem.first), (m - 1, problem.last)):
            if wanted is None:
                continue
            for i, stance in enumerate(wanted):
                rules.append(LimbRule(i, stance_in=(column,)) if stance else LimbRule(i, swing_in=(column,)))
        return tuple(rules)

    def violations(self, contact: Contact, problem: FootfallProblem) -> list[Violation]:
        found = []
        for column, wanted in ((0, problem.first), (problem.columns - 1, problem.last)):
            if wanted is None:
                continue
            wrong = (contact[:, column] != wanted).nonzero()[0]
            if len(wrong):
                found.append(self.violation(problem, wrong, [column], f"column {column} is not the one asked for"))
        return found
