"""The periodic and the transition program: the optimum, its ties, or a proof that there is nothing."""

from __future__ import annotations

import copy
import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from gaitforge.errors import UnsolvedError
from gaitforge.footfall.constraints import ConstraintSet
from gaitforge.footfall.counting import counting_clash
from gaitforge.footfall.explain import explain_infeasible, infeasible_footfall
from gaitforge.footfall.model import build_program, can_be_turned, check_pattern, check_problem, is_data
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.footfall.problem import FootfallProblem
from gaitforge.footfall.program import Program
from gaitforge.footfall.seam import distinct_gaits
from gaitforge.footfall.segments.listing import rotations
from gaitforge.footfall.solvers.base import FootfallSolver, Listing, Solution
from gaitforge.footfall.solvers.segments import Segments


@dataclass(frozen=True)
class SearchOptions:
    """How a pattern is looked for."""

    solver: FootfallSolver = field(default_factory=Segments)
    seed: int = 0
    time_limit_s: float = 10.0
    """[s] for the optimum and its proof"""
    listing_limit: int = 500
    """[patterns] most ties listed"""
    sample: int = 200
    """[patterns] most ties kept, spread evenly over those listed: neighbours in the list are much alike"""
    listing_s: float = 1.0
    """[s] most time for looking at ties"""


def solve(problem: FootfallProblem, families: Sequence[ConstraintSet], options: SearchOptions) -> FootfallPattern:
    """A pattern with the least Σ y.

    Raises InfeasibleFootfall with the clash when there is none, UnsolvedError when time ran out before
    either a pattern or a proof.
    """
    start = time.perf_counter()
    check_problem(problem)
    direct, reason = _direct(problem, families, options)
    if direct.contact is not None:
        return _pattern(direct.contact, problem, _info(direct, "segments", 0.0))
    if direct.status == "infeasible" or counting_clash(problem, families) is not None:
        raise infeasible_footfall(explain_infeasible(problem, families, options.solver, options.seed))
    program = build_program(problem, families, exact=not is_data(families))
    if direct.bound:
        program.row([(y, 1) for y in program.objective], direct.bound, None, "bound")
    built = time.perf_counter() - start
    solution = _minimize(program, can_be_turned(problem, families), options)
    if solution.status == "infeasible":
        raise infeasible_footfall(explain_infeasible(problem, families, options.solver, options.seed))
    if solution.contact is None:
        raise UnsolvedError(
            f"no footfall pattern of {problem.columns} columns found in {options.time_limit_s:g} s, and no proof "
            "that there is none",
            {"status": solution.status, "columns": problem.columns},
        )
    info = _info(solution, _general(options.solver).name, built)
    return _pattern(solution.contact, problem, {**info, "solver_reason": reason} if reason else info)


def _direct(
    problem: FootfallProblem, families: Sequence[ConstraintSet], options: SearchOptions
) -> tuple[Solution, str]:
    """What the search over change times says, when it is the one to ask; *unknown* and why when it cannot tell."""
    if isinstance(options.solver, Segments):
        return options.solver.search(problem, families)
    return Solution("unknown"), ""


def _general(solver: FootfallSolver) -> FootfallSolver:
    """The solver of the general model."""
    return solver.general if isinstance(solver, Segments) else solver


def _minimize(program: Program, turnable: bool, options: SearchOptions) -> Solution:
    """The optimum; of gaits that can be turned only those with a change at the seam are looked at first."""
    if turnable:
        solution = options.solver.minimize(_with_seam_change(program), options.time_limit_s, options.seed)
        if solution.status != "infeasible":
            return _recounted(solution, program)
    return _recounted(options.solver.minimize(program, options.time_limit_s, options.seed), program)


def _recounted(solution: Solution, program: Program) -> Solution:
    """Σ y as it is in the pattern: y is only bounded from below, and the row of the seam may have raised it."""
    if solution.contact is None:
        return solution
    problem = program.problem
    changes = FootfallPattern(solution.contact, problem.limbs, problem.cyclic).changes
    bound = solution.bound if solution.bound is None else min(solution.bound, changes)
    return replace(solution, objective=changes, bound=bound)


def _with_seam_change(program: Program) -> Program:
    """The same program with y_m−1 = 1: one of the m rotations of a gait that changes at all."""
    turned = copy.copy(program)
    turned.rows = list(program.rows)
    turned.row([(program.changed(program.problem.columns - 1), 1)], 1, None, "seam")
    return turned


def ties(
    problem: FootfallProblem,
    families: Sequence[ConstraintSet],
    best: FootfallPattern,
    options: SearchOptions,
    slack: int = 0,
) -> list[FootfallPattern]:
    """Distinct patterns with Σ y up to that of `best` + `slack`, `best` among them; bounded in number and time.

    Of cyclic patterns each gait is given once.
    """
    turnable = can_be_turned(problem, families)
    most = best.changes + slack
    found = _listed(problem, families, options, most)
    if found is None:
        found = _general_listing(problem, families, best, options, most)
        others = distinct_gaits(found.contacts) if turnable else found.contacts
    else:
        others = found.contacts
    same = rotations(best.contact) if turnable else {best.contact.tobytes()}
    kept = [best.contact, *(c for c in others if c.tobytes() not in same)]
    info = {**best.info, "ties": len(kept), "ties_complete": found.complete, "listing_s": found.solve_s}
    spread = np.unique(np.linspace(0, len(kept) - 1, min(len(kept), _sample(problem, options))).astype(int))
    return [_pattern(kept[k], problem, info) for k in spread]


def _listed(
    problem: FootfallProblem, families: Sequence[ConstraintSet], options: SearchOptions, most_changes: int
) -> Listing | None:
    """Ties by the search over change times, when it is the one to ask and can tell."""
    if isinstance(options.solver, Segments):
        return options.solver.ties(problem, families, most_changes, options.listing_limit)
    return None


def _general_listing(
    problem: FootfallProblem,
    families: Sequence[ConstraintSet],
    best: FootfallPattern,
    options: SearchOptions,
    most_changes: int,
) -> Listing:
    program = build_program(problem, families)
    if can_be_turned(problem, families) and best.changes:
        program = _with_seam_change(program)
    return options.solver.listing(
        program,
        most_changes=most_changes,
        limit=options.listing_limit,
        time_limit_s=options.listing_s,
        seed=options.seed,
    )


def _sample(problem: FootfallProblem, options: SearchOptions) -> int:
    """Ranking costs n_F² m a pattern, so fewer are kept for larger robots."""
    n, m = len(problem.limbs), problem.columns
    return max(options.sample // 5, min(options.sample, options.sample * 6 * 6 * 12 // (n * n * m)))


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
        "gap": solution.gap,
        "build_s": built + solution.build_s,
        "solve_s": solution.solve_s,
    }
