"""What g2, g3 and g4 share: how long a phase lasts at least."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gaitforge.footfall.constraints.base import Contact, LimbConstraint, Violation, require_at_least, rows_of
from gaitforge.footfall.constraints.rules import LimbRule
from gaitforge.footfall.constraints.runs import runs_of
from gaitforge.footfall.problem import FootfallProblem


@dataclass(frozen=True)
class PhaseLength(LimbConstraint):
    """No phase lasts `shortest` … `at_least` − 1 columns; phases cut off by an end of a transition are exempt."""

    stance: ClassVar[bool]
    """Whether stance phases are meant, or swing phases."""
    shortest: ClassVar[int] = 1
    """[columns] shorter ones are another family's"""

    at_least: int = 2
    """[columns]"""

    def __post_init__(self) -> None:
        require_at_least(self.key, "at_least", self.at_least, self.shortest)

    def rules(self, problem: FootfallProblem) -> tuple[LimbRule, ...]:
        too_short = tuple(range(self.shortest, self.at_least))
        walking = rows_of(problem, problem.locomotive_anywhere)
        if self.stance:
            return tuple(LimbRule(i, forbidden_stance_runs=too_short) for i in walking)
        return tuple(LimbRule(i, forbidden_swing_runs=too_short) for i in walking)

    def violations(self, contact: Contact, problem: FootfallProblem) -> list[Violation]:
        found = []
        for i in rows_of(problem, problem.locomotive_anywhere):
            for run in runs_of(contact[i], problem.cyclic):
                if run.whole and run.stance == self.stance and self.shortest <= run.length < self.at_least:
                    does = "stands" if self.stance else "swings"
                    text = f"{problem.limbs[i]} {does} for {run.length} of at least {self.at_least} columns"
                    found.append(self.violation(problem, [i], run.columns(problem.columns), text))
        return found
