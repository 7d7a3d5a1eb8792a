"""Why there is no pattern: the smallest set of families that clash, where, and what would help."""

from __future__ import annotations

import copy
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

from gaitforge.errors import InfeasibleFootfall
from gaitforge.footfall.constraints import ConstraintSet
from gaitforge.footfall.counting import Clash, counting_clash, with_columns
from gaitforge.footfall.demands import demands_of
from gaitforge.footfall.model import build_program
from gaitforge.footfall.problem import FootfallProblem
from gaitforge.footfall.program import Program
from gaitforge.footfall.solvers.base import FootfallSolver
from gaitforge.footfall.solvers.segments import Segments

BACKGROUND = "roles"
"""What the user asked for is never what is in the way."""


@dataclass(eq=False)
class _Prover:
    """Asks the solver whether some of the families clash; not proven within the time counts as no."""

    problem: FootfallProblem
    families: tuple[ConstraintSet, ...]
    solver: FootfallSolver
    seed: int
    deadline: float
    """[s] of this process, so that a busy machine finds the same clash"""

    def program(self, names: Iterable[str]) -> Program:
        wanted = {*names, BACKGROUND}
        return build_program(self.problem, [f for f in self.families if f.name in wanted])

    def infeasible(self, program: Program) -> bool:
        left = self.deadline - time.process_time()
        return left > 0 and self.solver.is_feasible(program, min(left, 1.0), self.seed) is False

    def clash(self, names: Iterable[str]) -> bool:
        return self.infeasible(self.program(names))


def explain_infeasible(
    problem: FootfallProblem,
    families: Sequence[ConstraintSet],
    solver: FootfallSolver,
    seed: int = 0,
    time_limit_s: float = 5.0,
) -> Clash:
    """The clash behind an infeasible problem: by counting where that is enough, else by removing families one by one.

    Every set named is proven to clash; it is the smallest one as far as the processor time allows.  Raises ValueError
    for a problem that has a pattern.
    """
    found = _found(problem, families, solver, seed, time_limit_s)
    demands = demands_of(problem, families, found.families, found.limbs)
    return replace(found, demands=demands, problem=problem)


def _found(
    problem: FootfallProblem, families: Sequence[ConstraintSet], solver: FootfallSolver, seed: int, time_limit_s: float
) -> Clash:
    prover = _Prover(problem, tuple(families), solver, seed, time.process_time() + time_limit_s)
    found = counting_clash(problem, families)
    if found is not None:
        return with_columns(found, _columns_that_help(prover)) if found.more_columns_help else found
    if solver.is_feasible(build_program(problem, families), time_limit_s, seed):
        raise ValueError("the problem has a pattern: there is nothing to explain")
    names = _smallest_core(prover)
    rows = _concerned(prover, names)
    longer = _columns_that_help(prover)
    return _described(problem, families, names, rows, longer)


def infeasible_footfall(clash: Clash) -> InfeasibleFootfall:
    """The exception that carries a clash."""
    return InfeasibleFootfall(f"{clash.text} {clash.advice}", clash.as_dict())


def _smallest_core(prover: _Prover) -> tuple[str, ...]:
    """Deletion filter, then every smaller subset: a deletion order can miss a smaller core."""
    names = tuple(dict.fromkeys(f.name for f in prover.families if f.name != BACKGROUND))
    core = _deleted(names, prover.clash)
    for size in range(len(core)):
        for subset in combinations(names, size):
            if prover.clash(subset):
                return subset
    return core


def _deleted(items: Sequence[Any], still_clashes: Callable[[list[Any]], bool]) -> tuple[Any, ...]:
    """Leave out one item after the other while the rest still clashes."""
    kept = list(items)
    for item in items:
        rest = [k for k in kept if k != item]
        if still_clashes(rest):
            kept = rest
    return tuple(kept)


def _concerned(prover: _Prover, names: Sequence[str]) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Limbs and columns of the rows that are needed for the clash; a cyclic gait has no special column."""
    program = prover.program(names)
    fixed = {"h1", "h2", BACKGROUND}
    limb_units = sorted({(r.family, r.limbs) for r in program.rows if len(r.limbs) == 1 and r.family not in fixed})
    column_units = sorted({(r.family, r.columns) for r in program.rows if len(r.columns) == 1 and len(r.limbs) > 1})
    if program.problem.cyclic:
        column_units = []

    def without(units: Iterable[tuple[str, tuple[int, ...]]]) -> bool:
        dropped = set(limb_units + column_units) - set(units)
        trial = copy.copy(program)
        trial.rows = [r for r in program.rows if not {(r.family, r.limbs), (r.family, r.columns)} & dropped]
        return prover.infeasible(trial)

    kept = _deleted(limb_units + column_units, without)
    limbs = {limbs[0] for _, limbs in kept if (_, limbs) in limb_units}
    columns = {columns[0] for _, columns in kept if (_, columns) in column_units}
    everyone = {i for r in program.rows if r.family in names and len(r.limbs) > 1 for i in r.limbs}
    return tuple(sorted(limbs or everyone)), tuple(sorted(columns or range(program.problem.columns)))


def _columns_that_help(prover: _Prover, most: int = 12) -> int | None:
    """The smallest number of columns, up to `most` more, with which there is a pattern."""
    for more in range(1, most + 1):
        longer = replace(prover.problem, columns=prover.problem.columns + more)
        quick, _ = Segments().search(longer, prover.families)
        if quick.status == "optimal":
            return longer.columns
        if quick.status == "infeasible":
            continue
        if time.process_time() > prover.deadline:
            return None
        if prover.solver.is_feasible(build_program(longer, prover.families), 1.0, prover.seed):
            return longer.columns
    return None


def _described(
    problem: FootfallProblem,
    families: Sequence[ConstraintSet],
    names: Sequence[str],
    rows: tuple[tuple[int, ...], tuple[int, ...]],
    longer: int | None,
) -> Clash:
    meaning = {f.name: f for f in families}
    limbs = tuple(problem.limbs[i] for i in rows[0])
    kind = "cyclic pattern" if problem.cyclic else "transition"
    shown = " and ".join(f"{name} ({meaning[name].title})" for name in names) or "the roles of the limbs"
    text = (
        f"No {kind} of {problem.columns} columns: {shown} cannot hold together for {', '.join(limbs) or 'the limbs'}."
    )
    reliefs = tuple(dict.fromkeys(meaning[name].relief for name in names)) or ("change the roles",)
    clash = Clash(tuple(names) or (BACKGROUND,), limbs, rows[1], text, reliefs, "core")
    return with_columns(clash, longer)
