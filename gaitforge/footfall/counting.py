"""Clashes that counting alone proves, without any solver: too few limbs for what has to stand and swing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from gaitforge.footfall.constraints import ColumnConstraint, ConstraintSet, LimbConstraint, StanceClause
from gaitforge.footfall.demands import Demand
from gaitforge.footfall.problem import FootfallProblem


@dataclass(frozen=True)
class Clash:
    """Families that cannot hold together, proven."""

    families: tuple[str, ...]
    limbs: tuple[str, ...]
    columns: tuple[int, ...]
    text: str
    """What clashes, in one sentence."""
    reliefs: tuple[str, ...]
    """What would help, each by itself."""
    proof: str
    """counting · core"""
    columns_needed: int | None = None
    """The smallest number of columns for which there is a pattern, where more columns help."""
    more_columns_help: bool = False
    """Whether it is worth looking for such a number."""
    demands: tuple[Demand, ...] = ()
    """What the families that clash ask for."""
    problem: FootfallProblem | None = None
    """What was asked for."""

    @property
    def advice(self) -> str:
        """What to change, in one sentence."""
        return sentence(", or ".join(self.reliefs)) + "."

    def as_dict(self) -> dict[str, Any]:
        """For `InfeasibleFootfall.explain` and ``summary.json``: plain lists, strings and numbers."""
        return {
            "families": list(self.families),
            "limbs": list(self.limbs),
            "columns": list(self.columns),
            "text": self.text,
            "advice": self.advice,
            "proof": self.proof,
            "columns_needed": self.columns_needed,
            "demands": [demand.as_dict() for demand in self.demands],
            "pattern": None if self.problem is None else frame_of(self.problem),
        }


def frame_of(problem: FootfallProblem) -> dict[str, Any]:
    """`explain["pattern"]`: the rows and columns that a picture of the clash has."""
    return {
        "limbs": list(problem.limbs),
        "limbs_locomotive": list(problem.locomotive_anywhere),
        "columns": problem.columns,
        "cyclic": problem.cyclic,
    }


def with_columns(clash: Clash, columns: int | None) -> Clash:
    """The clash with the number of columns that would help, None when none was found."""
    if columns is None:
        return clash
    return replace(clash, columns_needed=columns, reliefs=(f"use {columns} columns", *clash.reliefs))


def counting_clash(problem: FootfallProblem, families: Sequence[ConstraintSet]) -> Clash | None:
    """A smallest clash of a demand for stance with itself or with the swing duty, or None when counting finds none.

    A clause asks for k of the limbs S in every column: |S| ≥ k, and with w_i the least number of columns in
    which limb i swings, Σ_{i ∈ S} w_i ≤ (|S| − k) · m.
    """
    clauses = [(f, c) for f in families if isinstance(f, ColumnConstraint) for c in f.rules(problem)]
    for family, clause in clauses:
        if len(clause.limbs) < clause.at_least:
            return _too_few(problem, family, clause)
    for duty in families:
        if not isinstance(duty, LimbConstraint):
            continue
        swing = {rule.limb: rule.least_swing for rule in duty.rules(problem) if rule.least_swing}
        for family, clause in clauses:
            asked = sum(swing.get(i, 0) for i in clause.limbs)
            if asked > (len(clause.limbs) - clause.at_least) * problem.columns:
                return _no_time(problem, family, clause, duty, asked)
    return None


def _too_few(problem: FootfallProblem, family: ColumnConstraint, clause: StanceClause) -> Clash:
    names = tuple(problem.limbs[i] for i in clause.limbs)
    asked = f"{clause.at_least} of the {family.who} in stance in every column"
    text = f"{family.name} asks for {asked}, but {_walking(names)}."
    return Clash((family.name,), names, tuple(range(problem.columns)), text, (family.relief,), "counting")


def _no_time(
    problem: FootfallProblem, family: ColumnConstraint, clause: StanceClause, duty: ConstraintSet, asked: int
) -> Clash:
    m, names = problem.columns, tuple(problem.limbs[i] for i in clause.limbs)
    spare = len(names) - clause.at_least
    text = (
        f"{family.name} asks for {clause.at_least} of the {family.who} in stance in each of {m} columns, "
        f"but {_walking(names)}: that leaves {spare * m} swing columns, and {duty.name} asks for {asked}."
    )
    return Clash(
        (duty.name, family.name),
        names,
        tuple(range(m)),
        text,
        (family.relief, duty.relief),
        "counting",
        more_columns_help=spare > 0,
    )


def _walking(names: Sequence[str]) -> str:
    if not names:
        return "none walks"
    return f"only {', '.join(names)} {'walks' if len(names) == 1 else 'walk'}"


def sentence(text: str) -> str:
    """The text with a capital first letter, the others as they are."""
    return text[:1].upper() + text[1:]
