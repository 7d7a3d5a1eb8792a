"""The paper's own form of the program in Gurobi: quadratic equalities for h1, h2 and g1, families as printed rows."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from gaitforge.footfall.constraints import ConstraintSet
from gaitforge.footfall.model import build_program
from gaitforge.footfall.problem import FootfallProblem
from gaitforge.footfall.solvers.base import Solution


def minimize(problem: FootfallProblem, families: tuple[ConstraintSet, ...], time_limit_s: float, seed: int) -> Solution:
    """z_j = Σ_i (C_ij − C_i,j+1)², (y_j − 1) z_j = 0, Σ_j (C_ij − C_i,j+1)² ≤ 2; the other rows are linear in C."""
    import gurobipy as gp

    start = time.perf_counter()
    program = build_program(problem, families)
    n, m = len(problem.limbs), problem.columns
    with gp.Env(empty=True) as env:
        env.setParam("OutputFlag", 0)
        env.start()
        with gp.Model(env=env) as model:
            contact = model.addVars(n, m, vtype="B")
            changed = model.addVars(m - 1, vtype="B")
            counts = model.addVars(m - 1, lb=0, ub=n, vtype="I")
            for j in range(m - 1):
                model.addConstr(counts[j] == gp.quicksum(_change(contact, i, j) for i in range(n)))
                model.addConstr((changed[j] - 1) * counts[j] == 0)
            for i in range(n):
                model.addConstr(gp.quicksum(_change(contact, i, j) for j in range(m - 1)) <= 2)
            _add_linear_rows(gp, model, program, contact, n * m)
            model.setObjective(gp.quicksum(changed.values()))
            model.Params.Threads, model.Params.Seed, model.Params.TimeLimit = 1, seed, time_limit_s
            built = time.perf_counter()
            model.optimize()
            solved = time.perf_counter()
            proven = model.Status == gp.GRB.OPTIMAL
            cells = np.array([[contact[i, j].X > 0.5 for j in range(m)] for i in range(n)]) if model.SolCount else None
            objective = round(model.ObjVal) if model.SolCount else None
    status: Any = "optimal" if proven else "unknown" if cells is None else "feasible"
    return Solution(status, cells, objective, objective if proven else None, built - start, solved - built)


def _change(contact: Any, i: int, j: int) -> Any:
    return (contact[i, j] - contact[i, j + 1]) * (contact[i, j] - contact[i, j + 1])


def _add_linear_rows(gp: Any, model: Any, program: Any, contact: Any, cells: int) -> None:
    """Rows of the families but h1, h2 and g1; what balances limbs brings variables of its own."""
    m, extra = program.problem.columns, {}
    for row in program.rows:
        if row.family in ("h1", "h2", "g1"):
            continue
        terms = []
        for variable, coefficient in row.terms:
            if variable < cells:
                terms.append(coefficient * contact[divmod(variable, m)])
            else:
                low, high = program.bounds[variable]
                if variable not in extra:
                    extra[variable] = model.addVar(lb=low, ub=high, vtype="I")
                terms.append(coefficient * extra[variable])
        total = gp.quicksum(terms)
        if row.lower is not None and row.lower == row.upper:
            model.addConstr(total == row.lower)
        else:
            if row.lower is not None:
                model.addConstr(total >= row.lower)
            if row.upper is not None:
                model.addConstr(total <= row.upper)
