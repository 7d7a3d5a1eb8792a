"""IPOPT with MUMPS through CasADi: the reference solver."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.assembly import assemble
from gaitforge.motion.problem import Problem
from gaitforge.motion.solvers.solution import Multipliers, Solution, Start

Array = NDArray[np.float64]
GOOD = ("Solve_Succeeded", "Solved_To_Acceptable_Level")


@dataclass(frozen=True)
class Ipopt:
    """Interior points with exact second derivatives."""

    max_iterations: int = 80
    max_seconds: float = 30.0
    """[s] of processor time: a guard, set so wide that iterations decide and a busy machine changes nothing"""
    tolerance: float = 1e-7
    initial_barrier: float = 1e-2
    residual: float = 1e-6
    """Largest violation that still counts as solved [SI units of the row]."""

    def solve(self, problem: Problem, start: Start = None) -> Solution:
        """Solve from `start` (the problem's own guess when None)."""
        import casadi as ca

        begin = time.perf_counter()
        assembled = assemble(problem)
        options = {
            **assembled.options,
            "print_time": False,
            "verbose_init": False,
            "ipopt.print_level": 0,
            "ipopt.sb": "yes",
            "ipopt.max_iter": self.max_iterations,
            "ipopt.max_cpu_time": self.max_seconds,
            "ipopt.tol": self.tolerance,
            "ipopt.mu_init": self.initial_barrier,
            "ipopt.acceptable_tol": 1e-5,
            "ipopt.acceptable_constr_viol_tol": self.residual,
            "ipopt.acceptable_iter": 5,
        }
        solver = ca.nlpsol("motion", "ipopt", assembled.nlp, options)
        low, high = problem.bounds
        row_low, row_high = problem.row_bounds
        free = assembled.free
        from_x = start.x if isinstance(start, Solution) else start
        x0 = (problem.x0 if from_x is None else from_x)[free]
        out = solver(x0=x0, lbx=low[free], ubx=high[free], lbg=row_low, ubg=row_high)
        x = assembled.expand(problem, np.array(out["x"]).ravel())
        stats = solver.stats()
        bounds = np.zeros(problem.size)
        bounds[free] = np.array(out["lam_x"]).ravel()
        worst = problem.violations(x)
        residual = max((v[0] for v in worst.values()), default=0.0)
        solved = stats["return_status"] in GOOD and residual <= 10 * self.residual
        return Solution(
            x,
            solved,
            str(stats["return_status"]),
            int(stats["iter_count"]),
            time.perf_counter() - begin,
            float(out["f"]),
            float(residual),
            worst,
            Multipliers(np.array(out["lam_g"]).ravel(), bounds),
        )
