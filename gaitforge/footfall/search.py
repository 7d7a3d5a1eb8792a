"""The periodic and the transition program: the optimum, its ties, or a proof that there is nothing."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from gaitforge.errors import UnsolvedError
from gaitforge.footfall.constraints import ConstraintSet
from gaitforge.footfall.counting import counting_clash
from gaitforge.footfall.explain import explain_infeasible, infeasible_footfall
from gaitforge.footfall.model import build_program, check_pattern, check_problem
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.footfall.problem import FootfallProblem
from gaitforge.footfall.solvers.base import FootfallSolver, Solution
from gaitforge.footfall.solvers.cpsat import CpSat


@dataclass(frozen=True)
class SearchOptions:
    """How a pattern is looked for."""

    solver: FootfallSolver = field(default_factory=CpSat)
    seed: int = 0
    time_limit_s: float = 10.0
    """[s] for the optimum and its proof"""
    listing_limit: int = 300
    """[patterns] most ties looked at"""
    listing_s: float = 1.0
    """[s] most time for looking at ties"""


def solve(problem: FootfallProblem, families: Sequence[ConstraintSet], options: SearchOptions) -> FootfallPattern:
    """A pattern with the least Σ y.

    Raises InfeasibleFootfall with the clash when there is none, UnsolvedError when time ran out before
    either a pattern or a proof.
    """
    start = time.perf_counter()
    check_problem(problem)
    clash = counting_clash(problem, families)
    if clash is not None:
        raise infeasible_footfall(clash)
    program = build_program(problem, families)
    built = time.perf_counter() - start
    solution = options.solver.minimize(program, options.time_limit_s, options.seed)
    if solution.status == "infeasible":
        raise infeasible_footfall(explain_infeasible(problem, families, options.solver, options.seed))
    if solution.contact is None:
        raise UnsolvedError(
            f"no footfall pattern of {problem.columns} columns found in {options.time_limit_s:g} s, and no proof "
            "that there is none",
            {"status": solution.status, "columns": problem.columns},
        )
    return _pattern(solution.contact, problem, _info(solution, options.solver.name, built))


def ties(
    problem: FootfallProblem,
    families: Sequence[ConstraintSet],
    best: FootfallPattern,
    options: SearchOptions,
    slack: int = 0,
) -> list[FootfallPattern]:
    """Distinct patterns with Σ y up to that of `best` + `slack`, `best` among them; bounded in number and time.

    Cyclic patterns are listed with a change at the seam, which every gait can be turned to have.
    """
    program = build_program(problem, families)
    if problem.cyclic and best.changes:
        program.row([(program.changed(problem.columns - 1), 1)], 1, None, "seam")
    found = options.solver.listing(
        program,
        most_changes=best.changes + slack,
        limit=options.listing_limit,
        time_limit_s=options.listing_s,
        seed=options.seed,
    )
    info = {**best.info, "ties": len(found.contacts), "ties_complete": found.complete, "listing_s": found.solve_s}
    patterns = [_pattern(contact, problem, info) for contact in found.contacts]
    known = {p.contact.tobytes() for p in patterns}
    return patterns if best.contact.tobytes() in known else [best, *patterns]


def passes(contact: NDArray[np.bool_], problem: FootfallProblem, families: Sequence[ConstraintSet]) -> bool:
    """Whether no family finds anything wrong with a finished pattern."""
    return not check_pattern(contact, problem, families)


def _pattern(contact: NDArray[np.bool_], problem: FootfallProblem, info: dict[str, object]) -> FootfallPattern:
    return FootfallPattern(contact, problem.limbs, problem.cyclic, "program", info=info)


def _info(solution: Solution, name: str, built: float) -> dict[str, object]:
    return {
        "solver": name,
        "status": solution.status,
        "objective": solution.objective,
        "bound": solution.bound,
        "build_s": built + solution.build_s,
        "solve_s": solution.solve_s,
    }
