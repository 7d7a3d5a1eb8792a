"""When a transition leaves one gait and enters the other, and in how many columns."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from gaitforge.footfall.constraints import ConstraintSet
from gaitforge.footfall.from_robot import pattern_of, transition_problem
from gaitforge.footfall.model import build_program, check_problem
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.footfall.placement import offset_at
from gaitforge.footfall.problem import FootfallProblem
from gaitforge.footfall.ranking import Ranking, Travel, judged
from gaitforge.footfall.search import SearchOptions
from gaitforge.footfall.solvers.base import Solution
from gaitforge.footfall.solvers.segments import Segments

if TYPE_CHECKING:
    from gaitforge.robot.model import RobotModel

Phases = Literal["seam", "paper", "best"]
"""seam: what the gaits do next and did before, at the end and the start of a cycle; paper: the last column of the
one and the first of the other, section III-A; best: the best pair of columns"""
PHASES: tuple[Phases, ...] = ("seam", "paper", "best")
FEWEST, MOST = 4, 24
"""[columns] between which the shortest transition is looked for"""


def seam_problems(
    robot: RobotModel, before: Any, after: Any, columns: int, from_column: int | None, to_column: int | None,
    phases: Phases,
) -> list[FootfallProblem]:  # fmt: skip
    """The problems between the columns that `phases` allows; a column that is given is taken as it is."""
    old, new = pattern_of(robot, before, "before"), pattern_of(robot, after, "after")
    leave: Iterable[int | None] = (from_column,)
    enter: Iterable[int | None] = (to_column,)
    if phases == "paper":
        leave = (old.columns - 1 if from_column is None else from_column,)
        enter = (0 if to_column is None else to_column,)
    elif phases == "best":
        leave = range(old.columns) if from_column is None and old.cyclic else leave
        enter = range(new.columns) if to_column is None and new.cyclic else enter
    return [transition_problem(robot, old, new, columns, a, b) for a in leave for b in enter]


def transition_travel(robot: RobotModel, problem: FootfallProblem, before: Any, after: Any) -> Travel:
    """Travel per column, and where each foot comes from and has to leave, in columns of the transition."""
    nominal = robot.nominal
    per_column = nominal.speed * nominal.transition_column_s
    old, new = pattern_of(robot, before, "before"), pattern_of(robot, after, "after")
    coming = offset_at(old, problem.parameters["from_column"]) * _column_s(robot, old)
    leaving = offset_at(new, problem.parameters["to_column"] + 1) * _column_s(robot, new)
    scale = nominal.speed / per_column
    return Travel(np.array([per_column, 0.0]), (coming * scale, leaving * scale))


def _column_s(robot: RobotModel, gait: FootfallPattern) -> float:
    """[s] of a gait's column; one of more columns than nominal keeps the time of a column, not of a cycle."""
    return robot.nominal.duration / min(gait.columns, robot.nominal.columns)


def most_promising(
    problems: Sequence[FootfallProblem],
    families: Sequence[ConstraintSet],
    options: SearchOptions,
    travel: Callable[[FootfallProblem], Travel],
    ranking: Ranking,
    most: int = 4,
) -> list[FootfallProblem]:
    """The pairs of phases whose best pattern ranks highest, up to `most`; none when no pair has a pattern.

    Pairs between the same two columns have the same patterns, so each is solved once; feet that come from
    elsewhere make the difference between them.
    """
    known: dict[bytes, Solution] = {}
    found = []
    for problem in problems:
        ends = np.concatenate([np.asarray(problem.first), np.asarray(problem.last)]).tobytes()
        if ends not in known:
            known[ends] = optimum_of(problem, families, options)
        contact = known[ends].contact
        if contact is not None:
            pattern = FootfallPattern(contact, problem.limbs, False, "program")
            found.append((judged(pattern, problem, travel(problem), ranking)[0], problem))
    return [problem for _, problem in sorted(found, key=lambda item: item[0])[:most]]


def shortest(
    problems_of: Callable[[int], list[FootfallProblem]],
    families: Sequence[ConstraintSet],
    options: SearchOptions,
) -> int:
    """The smallest number of columns from `FEWEST` on with which some pair of phases has a pattern; else `MOST`."""
    for columns in range(FEWEST, MOST):
        if any(optimum_of(p, families, options).contact is not None for p in _distinct(problems_of(columns))):
            return columns
    return MOST


def _distinct(problems: Iterable[FootfallProblem]) -> Iterable[FootfallProblem]:
    """One problem for each pair of boundary columns."""
    ends = {np.concatenate([np.asarray(p.first), np.asarray(p.last)]).tobytes(): p for p in problems}
    return ends.values()


def optimum_of(problem: FootfallProblem, families: Sequence[ConstraintSet], options: SearchOptions) -> Solution:
    """The optimum, without an explanation when there is none."""
    check_problem(problem)
    if isinstance(options.solver, Segments):
        solution, _ = options.solver.search(problem, families)
        if solution.status != "unknown":
            return solution
    return options.solver.minimize(build_program(problem, families), options.time_limit_s, options.seed)


def with_seams(pattern: FootfallPattern, problem: FootfallProblem) -> FootfallPattern:
    """The pattern, and between which columns of the gaits it lies."""
    seams = {key: problem.parameters[key] for key in ("from_column", "to_column")}
    return replace(pattern, info={**pattern.info, **seams})
