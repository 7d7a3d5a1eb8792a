"""From a problem and its families to the general program, and the checks every problem passes first."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from gaitforge.errors import InputError, Problem
from gaitforge.footfall.constraints import ConstraintSet, LimbConstraint, Violation
from gaitforge.footfall.problem import FootfallProblem
from gaitforge.footfall.program import Program

LARGEST = 20_000
"""Most cells n_F · m of a pattern: far above every robot, far below what would fill the memory."""


def build_program(problem: FootfallProblem, families: Iterable[ConstraintSet], exact: bool = True) -> Program:
    """h1, h2 and the rows of every family; raises InputError for a problem that makes no sense.

    Without `exact` the program is one for minimising Σ y only; see `Program.exact`.
    """
    check_problem(problem)
    program = Program(problem, exact=exact)
    for family in families:
        family.write(program)
    return program


def check_pattern(
    contact: NDArray[np.bool_], problem: FootfallProblem, families: Iterable[ConstraintSet]
) -> tuple[Violation, ...]:
    """Everything that is wrong with a finished pattern (n_F, m), without any program."""
    return tuple(v for family in families for v in family.violations(contact, problem))


def is_data(families: Iterable[ConstraintSet]) -> bool:
    """Whether all families state data, so that nobody but the rules makes rows of variables x, y."""
    return all(f.scope != "general" and type(f).write is ConstraintSet.write for f in families)


def can_be_turned(problem: FootfallProblem, families: Iterable[ConstraintSet]) -> bool:
    """Whether every rotation of a solution is a solution: a cyclic problem without a family that names a column."""
    for family in families:
        if family.scope == "general":
            return False
        if isinstance(family, LimbConstraint):
            fixed = [c for rule in family.rules(problem) for c in (rule.swing_in, rule.stance_in)]
            if any(0 < len(columns) < problem.columns for columns in fixed):
                return False
    return problem.cyclic


def check_problem(problem: FootfallProblem) -> None:
    """Raise one InputError with everything that is wrong with the problem itself."""
    n, m, found = len(problem.limbs), problem.columns, []

    def wrong(key: str, what: object, expected: str) -> None:
        found.append(Problem("footfall", key, str(what), expected))

    if n < 1:
        wrong("limbs", n, "at least one limb")
    if isinstance(m, bool) or not isinstance(m, int | np.integer) or m < 2:
        wrong("columns", repr(m), "an integer ≥ 2")
    elif n * m > LARGEST:
        wrong("columns", f"{n} limbs × {m} columns", f"at most {LARGEST} cells")
    if len(set(problem.limbs)) != n:
        wrong("limbs", problem.limbs, "every name once")
    if len(problem.sides) != n or not set(problem.sides) <= {"left", "right", "middle"}:
        wrong("sides", problem.sides, f"left, right or middle for each of {n} limbs")
    for key, names in (("before", problem.locomotive_before), ("after", problem.locomotive_after)):
        for name in sorted(set(names) - set(problem.limbs)):
            wrong(f"locomotive_{key}", repr(name), "one of " + ", ".join(problem.limbs))
    if problem.cyclic:
        if set(problem.locomotive_before) != set(problem.locomotive_after):
            wrong("locomotive_after", problem.locomotive_after, "the same limbs as before, in a cyclic gait")
        if problem.first is not None or problem.last is not None:
            wrong("first, last", "fixed columns", "none in a cyclic gait")
    for key, column in (("first", problem.first), ("last", problem.last)):
        if column is not None and np.shape(column) != (n,):
            wrong(key, f"shape {np.shape(column)}", f"one value for each of {n} limbs")
    if found:
        raise InputError(found)
