"""The general program in Gurobi, for users who have it."""

from __future__ import annotations

import contextlib
import math
import time
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from gaitforge.errors import InputError, Problem
from gaitforge.footfall.constraints.base import require_at_least
from gaitforge.footfall.program import Program
from gaitforge.footfall.solvers.base import Solution, Status
from gaitforge.footfall.solvers.cuts import OneAtATime


@dataclass(frozen=True)
class Gurobi(OneAtATime):
    """Gurobi through gurobipy, which a user installs; its pip licence takes up to 2000 variables and rows."""

    name: ClassVar[str] = "gurobi"

    threads: int = 1
    """[threads]"""

    def __post_init__(self) -> None:
        require_at_least("footfall/solver", "threads", self.threads, 1)

    def _search(self, program: Program, time_limit_s: float, seed: int, minimize: bool) -> Solution:
        gurobi = _gurobipy()
        start = time.perf_counter()
        try:
            with gurobi.Env(empty=True) as env:
                env.setParam("OutputFlag", 0)
                env.start()
                with gurobi.Model(env=env) as model:
                    variables = _translate(gurobi, model, program, minimize)
                    model.Params.Threads, model.Params.Seed = self.threads, seed
                    model.Params.TimeLimit = max(time_limit_s, 1e-3)
                    built = time.perf_counter()
                    with contextlib.suppress(KeyboardInterrupt):  # it stops by itself and keeps the best pattern
                        model.optimize()
                    solved = time.perf_counter()
                    return _solution(gurobi, model, program, variables, minimize, built - start, solved - built)
        except gurobi.GurobiError as error:
            expected = f"a licence for {len(program.bounds)} variables and {len(program.rows)} rows, or another solver"
            raise InputError(Problem("footfall/solver", "gurobi", str(error), expected)) from error


def _gurobipy() -> Any:
    try:
        import gurobipy
    except ImportError as error:
        expected = "the package gurobipy, which gaitforge does not bring along; solver=segments needs nothing"
        raise InputError(Problem("footfall/solver", "gurobi", "no gurobipy", expected)) from error
    return gurobipy


def _translate(gurobi: Any, model: Any, program: Program, minimize: bool) -> Any:
    """Fill the model; returns its variables in the program's order."""
    low, high = np.array(program.bounds, dtype=float).T
    variables = model.addMVar(len(program.bounds), lb=low, ub=high, vtype=gurobi.GRB.INTEGER).tolist()
    for row in program.rows:
        terms = gurobi.LinExpr([c for _, c in row.terms], [variables[v] for v, _ in row.terms])
        if row.lower is not None and row.lower == row.upper:
            model.addLConstr(terms, gurobi.GRB.EQUAL, row.lower)
            continue
        if row.lower is not None:
            model.addLConstr(terms, gurobi.GRB.GREATER_EQUAL, row.lower)
        if row.upper is not None:
            model.addLConstr(terms, gurobi.GRB.LESS_EQUAL, row.upper)
    if minimize:
        model.setObjective(gurobi.quicksum(variables[y] for y in program.objective), gurobi.GRB.MINIMIZE)
    return variables


def _solution(
    gurobi: Any, model: Any, program: Program, variables: Any, minimize: bool, build_s: float, solve_s: float
) -> Solution:
    codes: dict[int, Status] = {
        gurobi.GRB.OPTIMAL: "optimal",
        gurobi.GRB.INFEASIBLE: "infeasible",
        gurobi.GRB.INF_OR_UNBD: "infeasible",  # every variable is bounded
    }
    status = codes.get(model.Status, "feasible" if model.SolCount else "unknown")
    bound = None
    if minimize and status != "infeasible" and math.isfinite(model.ObjBound):
        bound = math.ceil(model.ObjBound - 1e-6)
    if not model.SolCount:
        return Solution(status, bound=bound, build_s=build_s, solve_s=solve_s)
    values = np.array([round(v.X) for v in variables])
    changes = int(sum(values[y] for y in program.objective))
    return Solution(status, program.matrix(values), changes, bound, build_s, solve_s)
