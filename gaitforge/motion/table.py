"""The problem table: what a motion problem consists of, and which families have a say at its solution."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.family import Family
from gaitforge.motion.problem import Problem
from gaitforge.motion.report import TableRow

Array = NDArray[np.float64]
ACTIVE = 1e-6
"""[SI] a row or bound this near to its limit, or beyond it, is active"""


def problem_table(problem: Problem, x: Array, families: Iterable[Family] = ()) -> tuple[TableRow, ...]:
    """A row for every family, constraints first, and one for the bounds of the variables; x (size,): the solution."""
    where = {family.name: family.enforced for family in families}
    values = problem.constraint_values(x)
    names = dict.fromkeys(block.family for block in problem.rows)
    table = [_constraint(problem, name, values, where.get(name, "at samples")) for name in names]
    costs = dict.fromkeys(term.family for term in problem.terms if term.rows is None)
    table += [_cost(problem, name, x, where.get(name, "at samples")) for name in costs]
    return (*table, _bounds(problem, x))


def _constraint(problem: Problem, name: str, values: Array, enforced: str) -> TableRow:
    terms = [t for t in problem.terms if t.family == name and t.rows is not None]
    blocks = [b for b in problem.rows if b.family == name]
    at = np.concatenate([np.arange(b.start, b.start + len(b.lower)) for b in blocks])
    low, high = (np.concatenate([getattr(b, side) for b in blocks]) for side in ("lower", "upper"))
    active = np.minimum(values[at] - low, high - values[at]) <= ACTIVE
    read = np.unique(np.concatenate([t.variables.ravel() for t in terms])) if terms else np.zeros(0)
    places = sum(len(t.variables) for t in terms)
    return TableRow(name, "constraint", len(at), len(read), places, float(active.mean()), None, enforced)


def _cost(problem: Problem, name: str, x: Array, enforced: str) -> TableRow:
    terms = [t for t in problem.terms if t.family == name and t.rows is None]
    value = sum(
        float(np.sum(np.array(t.kernel.value.map(len(t.variables))(x[t.variables].T, t.parameters.T)))) for t in terms
    )
    read = np.unique(np.concatenate([t.variables.ravel() for t in terms]))
    return TableRow(name, "cost", 0, len(read), sum(len(t.variables) for t in terms), None, value, enforced)


def _bounds(problem: Problem, x: Array) -> TableRow:
    low, high = problem.bounds
    given = (np.isfinite(low) | np.isfinite(high)) & (low != high)
    active = np.minimum(x - low, high - x)[given] <= ACTIVE
    share = float(active.mean()) if given.any() else 0.0
    count = int(given.sum())
    return TableRow("bounds", "bound", count, count, count, share, None, "at samples: joints, feet, body, weights")
