"""The general program in OR-Tools' CP-SAT: exact, any family, the default."""

from __future__ import annotations

import time
from collections.abc import Sequence
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
        model = _translate(program)
        _minimize(model, program.objective, [1] * len(program.objective))
        built = time.perf_counter()
        solver, status = self._run(model, time_limit_s, seed)
        solved = time.perf_counter()
        values = solver.response_proto.solution if status in ("optimal", "feasible") else None
        contact = None if values is None else program.matrix(np.array(values))
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
        _, status = self._run(_translate(program), time_limit_s, seed)
        return {"optimal": True, "feasible": True, "infeasible": False, "unknown": None}[status]

    def listing(self, program: Program, *, most_changes: int, limit: int, time_limit_s: float, seed: int) -> Listing:
        """Up to `limit` distinct patterns with Σ y ≤ `most_changes`.

        CP-SAT lists neighbours one after the other, so when there are more a few are drawn along random
        directions as well.
        """
        start = time.perf_counter()
        model = _translate(program)
        _add_linear(model, Row(tuple((v, 1) for v in program.objective), None, most_changes, "listing"))
        found: dict[bytes, NDArray[np.bool_]] = {}
        complete = self._list_all(program, model, found, max(1, limit - DRAWS), 0.7 * time_limit_s, seed)
        if not complete:
            self._draw(program, model, found, start + time_limit_s, seed)
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
        if lean:
            parameters.max_presolve_iterations, parameters.cp_model_probing_level = 0, 0
            parameters.symmetry_level, parameters.linearization_level = 0, 0
            parameters.use_sat_inprocessing, parameters.use_phase_saving = False, False
        return solver

    def _list_all(
        self,
        program: Program,
        model: Any,
        found: dict[bytes, NDArray[np.bool_]],
        limit: int,
        time_limit_s: float,
        seed: int,
    ) -> bool:
        from ortools.sat.python import cp_model

        cells = _cells(program, model)

        class Collect(cp_model.CpSolverSolutionCallback):
            def on_solution_callback(self) -> None:
                contact = program.matrix(np.array([self.value(cell) for cell in cells]))
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
        found: dict[bytes, NDArray[np.bool_]],
        deadline: float,
        seed: int,
    ) -> None:
        """Extreme patterns along random directions in C."""
        rng = np.random.default_rng(seed)
        cells = range(len(program.problem.limbs) * program.problem.columns)
        for draw in range(DRAWS):
            if time.perf_counter() > deadline:
                return
            model.clear_objective()
            _minimize(model, cells, rng.integers(-9, 10, size=len(cells)).tolist())
            solver = self._solver(deadline - time.perf_counter(), seed + draw, lean=True)
            solver.parameters.max_deterministic_time = DRAW_WORK
            if solver.status_name(_solve(solver, model)[0]) not in ("OPTIMAL", "FEASIBLE"):
                continue
            contact = program.matrix(np.array(solver.response_proto.solution))
            found.setdefault(contact.tobytes(), contact)


def _solve(solver: Any, model: Any, callback: Any = None) -> tuple[Any, bool]:
    """CP-SAT's status, and whether Ctrl-C ended the search."""
    search = Interruptible(lambda: solver.solve(model, callback), solver.stop_search)
    return search.result(), search.interrupted


def _translate(program: Program) -> Any:
    """The CP-SAT model of a program, clauses as clauses; straight into the protocol buffer, which is much faster."""
    from ortools.sat.python import cp_model

    model = cp_model.CpModel()
    variables, constraints = model.proto.variables, model.proto.constraints
    for bounds in program.bounds:
        variables.add().domain.extend(bounds)
    boolean = [bounds == (0, 1) for bounds in program.bounds]
    for row in program.rows:
        literals = _literals(row, boolean)
        if literals is not None:
            constraints.add().bool_or.literals.extend(literals)
        else:
            _add_linear(model, row)
    return model


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


def _add_linear(model: Any, row: Row) -> None:
    from ortools.sat.python import cp_model

    linear = model.proto.constraints.add().linear
    linear.vars.extend([v for v, _ in row.terms])
    linear.coeffs.extend([c for _, c in row.terms])
    low = cp_model.INT_MIN if row.lower is None else row.lower
    linear.domain.extend([low, cp_model.INT_MAX if row.upper is None else row.upper])


def _minimize(model: Any, variables: Sequence[int], weights: Sequence[int]) -> None:
    objective = model.proto.objective
    objective.vars.extend(variables)
    objective.coeffs.extend(weights)


def _cells(program: Program, model: Any) -> list[Any]:
    """The variables C_ij, row by row, as a solution callback takes them."""
    cells = len(program.problem.limbs) * program.problem.columns
    return [model.get_bool_var_from_proto_index(v) for v in range(cells)]
