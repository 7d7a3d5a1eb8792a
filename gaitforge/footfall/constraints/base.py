"""What every constraint set g_k has: a sentence as data, rows made from it, and an independent check."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from gaitforge.errors import InputError, Problem
from gaitforge.footfall.constraints.rules import BalanceRule, ChangeRule, LimbRule, Rule, StanceClause
from gaitforge.footfall.problem import FootfallProblem
from gaitforge.footfall.program import Program

Scope = Literal["limb", "balance", "column", "change", "general"]
Contact = NDArray[np.bool_]


@dataclass(frozen=True)
class Violation:
    """One place where a finished pattern breaks a family."""

    family: str
    limbs: tuple[str, ...]
    columns: tuple[int, ...]
    text: str


class ConstraintSet(ABC):
    """A family g_k; subclasses are small frozen dataclasses whose fields are its parameters.

    Subclass one of the scopes below: `LimbConstraint`, `BalanceConstraint`, `ColumnConstraint`,
    `ChangeConstraint` state data; `GeneralConstraint` writes rows itself.
    """

    key: ClassVar[str]
    """g1, g2, …"""
    title: ClassVar[str]
    """A few words for a table."""
    equation: ClassVar[str]
    scope: ClassVar[Scope]
    family: ClassVar[str] = ""
    """Name in explanations when several keys say one sentence; else the key."""
    relief: ClassVar[str] = "relax it"
    """What a person may do when this family stands in the way."""

    @property
    def name(self) -> str:
        """The name used in explanations."""
        return self.family or self.key

    @abstractmethod
    def rules(self, problem: FootfallProblem) -> Sequence[Rule]:
        """The family's sentence for this problem, as data."""

    def write(self, program: Program) -> None:
        """Add the family's rows to a program."""
        for rule in self.rules(program.problem):
            rule.write(program, self.name)

    @abstractmethod
    def violations(self, contact: Contact, problem: FootfallProblem) -> list[Violation]:
        """Where the finished pattern `contact` (n_F, m) breaks the family; says nothing of how rows see it."""

    def violation(self, problem: FootfallProblem, limbs: Iterable[int], columns: Iterable[int], text: str) -> Violation:
        """A `Violation` of this family, limbs given as rows of C."""
        return Violation(self.name, tuple(problem.limbs[i] for i in limbs), tuple(int(j) for j in columns), text)


class LimbConstraint(ConstraintSet):
    """A rule on one row: g1–g5."""

    scope: ClassVar[Scope] = "limb"

    @abstractmethod
    def rules(self, problem: FootfallProblem) -> Sequence[LimbRule]: ...


class BalanceConstraint(ConstraintSet):
    """Work shared between limbs: g6, g7."""

    scope: ClassVar[Scope] = "balance"

    @abstractmethod
    def rules(self, problem: FootfallProblem) -> Sequence[BalanceRule]: ...


class ColumnConstraint(ConstraintSet):
    """The same demand for stance in every column: g8–g11."""

    scope: ClassVar[Scope] = "column"
    who: ClassVar[str] = "limbs"
    """Which limbs are asked, for sentences."""

    @abstractmethod
    def rules(self, problem: FootfallProblem) -> Sequence[StanceClause]: ...


class ChangeConstraint(ConstraintSet):
    """What may happen at one change time: the gap rule."""

    scope: ClassVar[Scope] = "change"

    @abstractmethod
    def rules(self, problem: FootfallProblem) -> Sequence[ChangeRule]: ...


class GeneralConstraint(ConstraintSet):
    """Anything else: it writes its rows itself, and only the general program can take it."""

    scope: ClassVar[Scope] = "general"

    def rules(self, problem: FootfallProblem) -> Sequence[Rule]:
        return ()

    @abstractmethod
    def write(self, program: Program) -> None: ...


def rows_of(problem: FootfallProblem, names: Iterable[str]) -> tuple[int, ...]:
    """Rows of C of the named limbs, in the order of the rows."""
    wanted = set(names)
    return tuple(i for i, name in enumerate(problem.limbs) if name in wanted)


def require_at_least(key: str, parameter: str, value: int, least: int) -> None:
    """Raise InputError unless `value` is an integer of at least `least`."""
    if isinstance(value, bool) or not isinstance(value, int) or value < least:
        raise InputError(Problem("footfall/constraints", f"{key}.{parameter}", repr(value), f"an integer ≥ {least}"))
