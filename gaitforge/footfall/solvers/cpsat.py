"""The general program in OR-Tools' CP-SAT: exact, any family, the default."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from gaitforge.errors import InputError, Problem
from gaitforge.footfall.program import Program, Row
from gaitforge.footfall.solvers.base import Listing, Solution, Status
from gaitforge.footfall.solvers.interrupt import Interruptible

DRAWS = 12
"""Patterns drawn along random directions when there are too many to list."""
DRAW_WORK = 0.01
"""CP-SAT's deterministic time for one of them, about as many seconds."""


@dataclass(frozen=True)
class CpSat:
    """Settings of CP-SAT; one worker and a seed reproduce a pattern, more workers may not."""

    name: ClassVar[str] = "cpsat"

    workers: int = 1
    """[threads]"""
    lean: bool = True
    """Try first with little presolve, which is much faster on most instances but bad at counting proofs."""
    lean_time_s: float = 0.5
    """[s] of the lean try, before the default settings take over"""

    def __post_init__(self) -> None:
        if self.workers < 1:
            raise InputError(Problem("footfall/solver", "workers", repr(self.workers), "an integer ≥ 1"))
        if not self.lean_time_s > 0:
            raise InputError(Problem("footfall/solver", "lean_time_s", repr(self.lean_time_s), "a time > 0 [s]"))

    def minimize(self, program: Program, time_limit_s: float, seed: int) -> Solution:
        """The pattern with the least Σ y."""
        start = time.perf_counter()
        model, variables = _translate(program)
        model.minimize(sum(variables[v] for v in program.objective))
        built = time.perf_counter()
        solver, status = self._run(model, time_limit_s, seed)
        solved = time.perf_counter()
        contact = _contact(program, solver, variables) if status in ("optimal", "feasible") else None
        return Solution(
            status=status,
            contact=contact,
            objective=None if contact is None else round(solver.objective_value),
            bound=None if status in ("infeasible", "unknown") else int(np.ceil(solver.best_objective_bound - 1e-6)),
            build_s=built - start,
            solve_s=solved - built,
        )

    def is_feasible(self, program: Program, time_limit_s: float, seed: int) -> bool | None:
        """Whether the program has a solution; None when time ran out before a proof."""
        model, _ = _translate(program)
        _, status = self._run(model, time_limit_s, seed)
        return {"optimal": True, "feasible": True, "infeasible": False, "unknown": None}[status]

    def listing(self, program: Program, *, most_changes: int, limit: int, time_limit_s: float, seed: int) -> Listing:
        """Up to `limit` distinct patterns with Σ y ≤ `most_changes`.

        CP-SAT lists neighbours one after the other, so when there are more a few are drawn along random
        directions as well.
        """
        start = time.perf_counter()
        model, variables = _translate(program)
        model.add(sum(variables[v] for v in program.objective) <= most_changes)
        found: dict[bytes, NDArray[np.bool_]] = {}
        complete = self._list_all(program, model, variables, found, max(1, limit - DRAWS), 0.7 * time_limit_s, seed)
        if not complete:
            self._draw(program, model, variables, found, start + time_limit_s, seed)
        return Listing(tuple(found.values()), complete, time.perf_counter() - start)

    def _run(self, model: Any, time_limit_s: float, seed: int) -> tuple[Any, Status]:
        from ortools.sat.python import cp_model

        names: dict[Any, Status] = {
            cp_model.OPTIMAL: "optimal",
            cp_model.FEASIBLE: "feasible",
            cp_model.INFEASIBLE: "infeasible",
        }
        found: Status = "unknown"
        first = None
        if self.lean:
            first = self._solver(min(self.lean_time_s, time_limit_s), seed, lean=True)
            code, interrupted = _solve(first, model)
            found = names.get(code, "unknown")
            time_limit_s -= first.wall_time
            if found in ("optimal", "infeasible") or time_limit_s <= 0 or interrupted:
                return first, found
        solver = self._solver(time_limit_s, seed, lean=False)
        status = names.get(_solve(solver, model)[0], "unknown")
        return (first, found) if status == "unknown" and first is not None else (solver, status)

    def _solver(self, time_limit_s: float, seed: int, lean: bool) -> Any:
        from ortools.sat.python import cp_model

        solver = cp_model.CpSolver()
        parameters = solver.parameters
        parameters.num_workers, parameters.random_seed = self.workers, seed
        parameters.catch_sigint_signal = False  # else Python never hears Ctrl-C again
        parameters.max_time_in_seconds = max(time_limit_s, 1e-3)
        # By default the first solve takes Ctrl-C away from Python for good.
        parameters.catch_sigint_signal = False
        if lean:
            parameters.max_presolve_iterations, parameters.cp_model_probing_level = 1, 0
            parameters.symmetry_level, parameters.linearization_level = 0, 0
        return solver

    def _list_all(
        self,
        program: Program,
        model: Any,
        variables: list[Any],
        found: dict[bytes, NDArray[np.bool_]],
        limit: int,
        time_limit_s: float,
        seed: int,
    ) -> bool:
        from ortools.sat.python import cp_model

        class Collect(cp_model.CpSolverSolutionCallback):
            def on_solution_callback(self) -> None:
                contact = _contact(program, self, variables)
                found.setdefault(contact.tobytes(), contact)
                if len(found) >= limit:
                    self.stop_search()

        solver = self._solver(time_limit_s, seed, lean=True)
        solver.parameters.num_workers, solver.parameters.enumerate_all_solutions = 1, True
        status, _ = _solve(solver, model, Collect())
        return bool(status in (cp_model.OPTIMAL, cp_model.INFEASIBLE))

    def _draw(
        self,
        program: Program,
        model: Any,
        variables: list[Any],
        found: dict[bytes, NDArray[np.bool_]],
        deadline: float,
        seed: int,
    ) -> None:
        """Extreme patterns along random directions in C."""
        rng = np.random.default_rng(seed)
        cells = len(program.problem.limbs) * program.problem.columns
        for draw in range(DRAWS):
            if time.perf_counter() > deadline:
                return
            weights = rng.integers(-9, 10, size=cells)
            model.clear_objective()
            model.minimize(sum(int(w) * v for w, v in zip(weights, variables[:cells], strict=True)))
            solver = self._solver(deadline - time.perf_counter(), seed + draw, lean=True)
            solver.parameters.max_deterministic_time = DRAW_WORK
            if solver.status_name(_solve(solver, model)[0]) not in ("OPTIMAL", "FEASIBLE"):
                continue
            contact = _contact(program, solver, variables)
            found.setdefault(contact.tobytes(), contact)


def _solve(solver: Any, model: Any, callback: Any = None) -> tuple[Any, bool]:
    """CP-SAT's status, and whether Ctrl-C ended the search."""
    search = Interruptible(lambda: solver.solve(model, callback), solver.stop_search)
    return search.result(), search.interrupted


def _translate(program: Program) -> tuple[Any, list[Any]]:
    """The CP-SAT model of a program, clauses as clauses, and its variables."""
    from ortools.sat.python import cp_model

    model = cp_model.CpModel()
    variables = [
        model.new_bool_var("") if (low, high) == (0, 1) else model.new_int_var(low, high, "")
        for low, high in program.bounds
    ]
    boolean = [bounds == (0, 1) for bounds in program.bounds]
    constraints = model.proto.constraints  # straight into the protocol buffer: half of the time of the methods
    for row in program.rows:
        literals = _literals(row, boolean)
        if literals is not None:
            constraints.add().bool_or.literals.extend(literals)
        else:
            _add_linear(constraints.add().linear, row, cp_model.INT_MIN, cp_model.INT_MAX)
    return model, variables


def _literals(row: Row, boolean: list[bool]) -> list[int] | None:
    """The row as a clause, when it is one: Σ ± v ≥ 1 − (number of minus signs) over 0/1 variables; ¬v is −v − 1."""
    if row.upper is not None:
        return None
    literals, negative = [], 0
    for v, c in row.terms:
        if not boolean[v] or (c != 1 and c != -1):
            return None
        if c < 0:
            negative += 1
            v = -v - 1
        literals.append(v)
    return literals if row.lower == 1 - negative else None


def _add_linear(linear: Any, row: Row, least: int, most: int) -> None:
    linear.vars.extend([v for v, _ in row.terms])
    linear.coeffs.extend([c for _, c in row.terms])
    linear.domain.extend([least if row.lower is None else row.lower, most if row.upper is None else row.upper])


def _contact(program: Program, source: Any, variables: list[Any]) -> NDArray[np.bool_]:
    """C out of a solver or a solution callback."""
    n, m = len(program.problem.limbs), program.problem.columns
    cells = [bool(source.value(v)) for v in variables[: n * m]]
    return np.array(cells, dtype=bool).reshape(n, m)
