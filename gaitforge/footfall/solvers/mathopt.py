"""The general program in HiGHS or SCIP, through OR-Tools' MathOpt."""

from __future__ import annotations

import datetime
import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Literal

import numpy as np

from gaitforge.errors import InputError, Problem, UnsolvedError
from gaitforge.footfall.program import Program
from gaitforge.footfall.solvers.base import Solution, Status
from gaitforge.footfall.solvers.cuts import OneAtATime
from gaitforge.footfall.solvers.interrupt import Interruptible

BACKENDS = ("highs", "scip")
FIRST_TRY = 2.0
"""[s] of the first try; each further one is three times as long and begins with the best pattern so far"""


@dataclass(frozen=True)
class MathOpt(OneAtATime):
    """A mixed-integer solver that comes with OR-Tools; one thread.

    Neither can be stopped from outside, so a long search is cut into tries of growing length: on Ctrl-C
    the best pattern of the tries that are over is returned, with its gap.
    """

    backend: Literal["highs", "scip"] = "highs"
    """highs · scip"""

    def __post_init__(self) -> None:
        if self.backend not in BACKENDS:
            raise InputError(Problem("footfall/solver", "backend", repr(self.backend), " or ".join(BACKENDS)))

    @property
    def name(self) -> str:
        """For summaries."""
        return self.backend

    def _search(self, program: Program, time_limit_s: float, seed: int, minimize: bool) -> Solution:
        start = time.perf_counter()
        model, variables = _translate(program, minimize)
        built = time.perf_counter()
        best = Solution("unknown")
        hint: dict[Any, float] = {}
        for seconds in _tries(time_limit_s):
            result = Interruptible(partial(self._run, model, seconds, seed, hint)).result()
            if result is None:
                break
            if result.has_primal_feasible_solution():
                hint = result.variable_values()
            best = _better(best, _solution(program, variables, result, minimize))
            if best.status in ("optimal", "infeasible") or (best.contact is not None and not minimize):
                break
        return replace(best, build_s=built - start, solve_s=time.perf_counter() - built)

    def _run(self, model: Any, time_limit_s: float, seed: int, hint: dict[Any, float]) -> Any:
        from ortools.math_opt.python import mathopt

        solver = {"highs": mathopt.SolverType.HIGHS, "scip": mathopt.SolverType.GSCIP}[self.backend]
        limit = datetime.timedelta(seconds=time_limit_s)
        begin = [mathopt.SolutionHint(variable_values=hint)] if hint else []
        parameters = mathopt.SolveParameters(time_limit=limit, random_seed=seed)
        begin_with = mathopt.ModelSolveParameters(solution_hints=begin)
        try:
            return mathopt.solve(model, solver, params=parameters, model_params=begin_with)
        except Exception as error:  # MathOpt has no root of its own for what its solvers raise
            raise UnsolvedError(f"{self.backend} gave up: {error}") from error


def _tries(time_limit_s: float) -> Iterator[float]:
    """Lengths of the tries, together about the limit [s]."""
    length, end = FIRST_TRY, time.perf_counter() + time_limit_s
    while (left := end - time.perf_counter()) > 1e-3:
        # a rest too short for a further try of its own is added to this one
        yield left if left < 2 * length else length
        length *= 3


def _translate(program: Program, minimize: bool) -> tuple[Any, list[Any]]:
    """The MathOpt model of a program, and its variables."""
    from ortools.math_opt.python import mathopt

    model = mathopt.Model()
    variables = [model.add_variable(lb=low, ub=high, is_integer=True) for low, high in program.bounds]
    for row in program.rows:
        low = -math.inf if row.lower is None else row.lower
        high = math.inf if row.upper is None else row.upper
        constraint = model.add_linear_constraint(lb=low, ub=high)
        for variable, coefficient in row.terms:
            constraint.set_coefficient(variables[variable], coefficient)
    if minimize:
        for y in program.objective:
            model.objective.set_linear_coefficient(variables[y], 1.0)
    return model, variables


def _solution(program: Program, variables: list[Any], result: Any, minimize: bool) -> Solution:
    from ortools.math_opt.python import mathopt

    reason = mathopt.TerminationReason
    names: dict[Any, Status] = {
        reason.OPTIMAL: "optimal",
        reason.FEASIBLE: "feasible",
        reason.INFEASIBLE: "infeasible",
        reason.INFEASIBLE_OR_UNBOUNDED: "infeasible",  # every variable is bounded
    }
    status = names.get(result.termination.reason, "unknown")
    dual = result.termination.objective_bounds.dual_bound
    bound = math.ceil(dual - 1e-6) if minimize and status != "infeasible" and math.isfinite(dual) else None
    if not result.has_primal_feasible_solution():
        return Solution(status, bound=bound)
    values = np.array([round(value) for value in result.variable_values(variables)])
    changes = int(sum(values[y] for y in program.objective))
    if bound is not None and bound >= changes:
        status = "optimal"
    return Solution(status, program.matrix(values), changes, bound)


def _better(old: Solution, new: Solution) -> Solution:
    """The better pattern of two tries at one program, and the better bound."""
    if new.status in ("optimal", "infeasible"):
        return new
    known = [s.bound for s in (old, new) if s.bound is not None]
    patterns = [s for s in (old, new) if s.objective is not None]
    best = min(patterns, key=lambda s: s.objective or 0, default=new)
    return replace(best, bound=max(known, default=None))
