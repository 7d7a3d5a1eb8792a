"""Footfall patterns for a robot: gaits for whatever limbs walk, and transitions between them.

The cascade of section III-B: with one limb lost, candidates like the gait before; else the alternating tripod;
then the periodic program with its ties, then the wave.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from gaitforge.errors import InfeasibleFootfall, InputError, Problem
from gaitforge.footfall.constraints import ConstraintSet, Families, with_problem_families
from gaitforge.footfall.counting import frame_of
from gaitforge.footfall.demands import demands_of
from gaitforge.footfall.from_robot import gait_problem, limbs_named, pattern_of
from gaitforge.footfall.gaps import gapped_first
from gaitforge.footfall.given import alternating
from gaitforge.footfall.lost_limb import Left, lost_limb, lost_limb_gaits
from gaitforge.footfall.model import can_be_turned, check_pattern, check_problem
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.footfall.phases import (
    PHASES,
    Phases,
    most_promising,
    seam_problems,
    shortest,
    transition_travel,
    with_seams,
)
from gaitforge.footfall.placement.place import placed_pattern, prepared, sectors_of, swayed
from gaitforge.footfall.problem import FootfallProblem
from gaitforge.footfall.ranking import RANKINGS, Ranking, Travel, diverse, judged, ranked
from gaitforge.footfall.seam import at_grounded_seam, canonical
from gaitforge.footfall.search import SearchOptions, passes, solve, ties
from gaitforge.footfall.solvers.base import FootfallSolver
from gaitforge.footfall.solvers.segments import Segments
from gaitforge.footfall.waves import best_wave, swing_columns_for

if TYPE_CHECKING:
    from gaitforge.robot.model import RobotModel

Method = Literal["auto", "tripod", "wave", "program"]
METHODS: tuple[Method, ...] = ("auto", "tripod", "wave", "program")


def synthesize_gait_pattern(
    robot: RobotModel,
    *,
    locomotive: Iterable[str] | None = None,
    columns: int = 12,
    constraints: Families | None = None,
    seed: int = 0,
    time_limit_s: float = 10.0,
    method: Method = "auto",
    solver: FootfallSolver | None = None,
    original: Any = None,
    ranking: Ranking = "margin",
) -> FootfallPattern:
    """A cyclic footfall pattern for the limbs that walk (None: all), begun where they are all on the ground.

    `method`: *tripod* (alternating), *program* (least Σ y, ties ranked by margin), *wave* (m = n (s + 1), not
    `columns`), or *auto*: the first of these that satisfies every family.  `original`: the gait before (a pattern,
    or a plan that has one), for *auto* when one of its limbs is lost; `ranking`: what decides between patterns
    (see `ranked`).  Raises InputError for limbs that do not exist, InfeasibleFootfall with the clash of families,
    UnsolvedError when time ran out.
    """
    return gait_pattern_candidates(
        robot,
        locomotive=locomotive,
        columns=columns,
        limit=1,
        constraints=constraints,
        seed=seed,
        time_limit_s=time_limit_s,
        method=method,
        solver=solver,
        original=original,
        ranking=ranking,
    )[0]


def gait_pattern_candidates(
    robot: RobotModel,
    *,
    locomotive: Iterable[str] | None = None,
    columns: int = 12,
    limit: int = 6,
    constraints: Families | None = None,
    seed: int = 0,
    time_limit_s: float = 10.0,
    method: Method = "auto",
    solver: FootfallSolver | None = None,
    original: Any = None,
    ranking: Ranking = "margin",
) -> tuple[FootfallPattern, ...]:
    """Up to `limit` cyclic patterns, the most promising first; all satisfy every family.

    Arguments and errors as in `synthesize_gait_pattern`.  With *auto* the last one or two are waves, whose
    number of columns is their own.
    """
    if method not in METHODS:
        raise InputError(Problem("footfall", "method", repr(method), "one of " + ", ".join(METHODS)))
    if ranking not in RANKINGS:
        raise InputError(Problem("footfall", "ranking", repr(ranking), "one of " + ", ".join(RANKINGS)))
    if limit < 1:
        raise InputError(Problem("footfall", "limit", repr(limit), "an integer ≥ 1"))
    problem, families = gait_problem(robot, locomotive, columns), with_problem_families(constraints)
    check_problem(problem)
    options = SearchOptions(solver or Segments(), seed, time_limit_s)
    asked, ready = (problem, families), prepared(robot, problem, families, options)
    problem, families = ready.problem, ready.families
    travel = Travel(np.array([robot.nominal.speed * robot.nominal.duration / columns, 0.0]))
    if method == "tripod":
        found = _tripod(problem, families, required=True)
    elif method == "wave":
        found = _waves(problem, families, travel, required=True)
    elif method == "program":
        found = _program(problem, families, travel, options, limit, ranking)
    else:
        gait_before = None if original is None else pattern_of(robot, original, "original")
        found = _cascade(problem, families, travel, options, limit, gait_before, ranking)
    turnable = can_be_turned(problem, families)
    chosen = _once(at_grounded_seam(pattern) if turnable else pattern for pattern in found)[:limit]
    return tuple(ready.finish(chosen)) or (placed_pattern(robot, *asked, options),)


def synthesize_transition_pattern(
    robot: RobotModel,
    before: Any,
    after: Any,
    *,
    columns: int | Literal["shortest"] = 11,
    from_column: int | None = None,
    to_column: int | None = None,
    phases: Phases = "seam",
    constraints: Families | None = None,
    seed: int = 0,
    time_limit_s: float = 10.0,
    solver: FootfallSolver | None = None,
    ranking: Ranking = "margin",
) -> FootfallPattern:
    """The best-ranked transition pattern between two patterns (or plans that have a `.pattern`).

    The first column is what the gait before does next (`from_column`, its column 0), the last what the gait
    after would have done just before (`to_column`, its last column).  `phases`: *paper* takes the last column of
    the one and the first of the other instead, *best* the best pair of columns; `info` says which were taken.
    `columns`: their number, or *shortest* for the smallest one that has a pattern.  Raises InputError,
    InfeasibleFootfall (with `explain["columns_needed"]` when more columns help) or UnsolvedError.
    """
    return transition_pattern_candidates(
        robot,
        before,
        after,
        columns=columns,
        limit=1,
        from_column=from_column,
        to_column=to_column,
        phases=phases,
        constraints=constraints,
        seed=seed,
        time_limit_s=time_limit_s,
        solver=solver,
        ranking=ranking,
    )[0]


def transition_pattern_candidates(
    robot: RobotModel,
    before: Any,
    after: Any,
    *,
    columns: int | Literal["shortest"] = 11,
    limit: int = 8,
    from_column: int | None = None,
    to_column: int | None = None,
    phases: Phases = "seam",
    slack: int = 1,
    constraints: Families | None = None,
    seed: int = 0,
    time_limit_s: float = 10.0,
    solver: FootfallSolver | None = None,
    ranking: Ranking = "margin",
) -> tuple[FootfallPattern, ...]:
    """Up to `limit` transition patterns with Σ y ≤ optimum + `slack`, diverse, the most promising first.

    Ranked by static margin with each foot where it is before or after its own step, then by Σ y; arguments
    and errors as in `synthesize_transition_pattern`.  g11 does not choose a transition: the body is on its way;
    the margin that placed footholds give it stands in `info` and, when below δ, in `relaxed`.
    """
    for key, value, known in (("phases", phases, PHASES), ("ranking", ranking, RANKINGS)):
        if value not in known:
            raise InputError(Problem("footfall", key, repr(value), "one of " + ", ".join(known)))
    families = with_problem_families(constraints)
    g11 = sectors_of(families)
    families = tuple(f for f in families if f is not g11)
    options = SearchOptions(solver or Segments(), seed, time_limit_s)

    def problems_of(m: int) -> list[FootfallProblem]:
        return seam_problems(robot, before, after, m, from_column, to_column, phases)

    def travel(problem: FootfallProblem) -> Travel:
        return transition_travel(robot, problem, before, after)

    problems = problems_of(shortest(problems_of, families, options) if columns == "shortest" else columns)
    if len(problems) > 1:
        problems = most_promising(problems, families, options, travel, ranking) or problems[:1]
        options = replace(options, sample=options.sample // len(problems))
    measured = []
    for problem in problems:
        best = solve(problem, families, options)
        for tie in ties(problem, families, best, options, slack):
            measured.append(judged(with_seams(tie, problem), problem, travel(problem), ranking))
    found = diverse([pattern for _, pattern in sorted(measured, key=lambda item: item[0])], limit)
    return found if g11 is None else tuple(swayed(robot, p, problems[0], g11) for p in found)


def _cascade(
    problem: FootfallProblem, families: tuple[ConstraintSet, ...], travel: Travel, options: SearchOptions, limit: int,
    original: FootfallPattern | None, ranking: Ranking,
) -> list[FootfallPattern]:  # fmt: skip
    """Candidates, program, wave; the program's proof is raised only when no other method has a pattern.

    Candidates of a lost limb and ties of the program are ranked together, the best of each kind before the
    others: none like the gait before may be any good.
    """
    lost = lost_limb(problem, original)
    left: Left = ()
    if lost is None:
        found = _tripod(problem, families)
        if found and limit == 1:
            return found
    else:
        found, left = lost_limb_gaits(problem, families, travel, *lost, ranking)
        found = found[: max(2, limit // 2)]
    failure: InfeasibleFootfall | None = None
    try:
        program = _program(problem, families, travel, options, max(1, limit - 2), ranking)
        found = found + program if lost is None else _both(ranked(found + program, problem, travel, ranking))
    except InfeasibleFootfall as error:
        failure = error
    found = [replace(p, info={**p.info, "left": left}) for p in gapped_first(found, problem, families)]
    if limit == 1 and found:
        return found
    waves = _waves(problem, families, travel)
    if failure is not None and not found:
        if not waves:
            raise failure
        note = f"{waves[0].columns} columns instead of {problem.columns}"
        waves = [replace(w, relaxed=(note,)) for w in waves]
    kept = max(1, limit - min(2, len(waves)))
    return found[:kept] + waves


def _both(patterns: Iterable[FootfallPattern]) -> list[FootfallPattern]:
    """The first pattern of each source, then the others in their order."""
    best: dict[str, FootfallPattern] = {}
    rest = [p for p in patterns if best.setdefault(p.source, p) is not p]
    return [*best.values(), *rest]


def _tripod(
    problem: FootfallProblem, families: tuple[ConstraintSet, ...], required: bool = False
) -> list[FootfallPattern]:
    """Alternating patterns that satisfy every family: of all limbs with some free, and of the walking ones alone."""
    walking = set(problem.locomotive_anywhere)
    rows = [i for i, name in enumerate(problem.limbs) if name in walking]
    whole = alternating(problem.limbs, problem.sides, problem.columns)
    contact = whole.contact.copy()
    contact[[i for i in range(len(problem.limbs)) if i not in rows]] = False
    original = replace(whole, contact=contact, source="candidate")
    found = [original]
    if rows and len(rows) < len(problem.limbs):
        again = np.zeros_like(contact)
        names, sides = [problem.limbs[i] for i in rows], [problem.sides[i] for i in rows]
        again[rows] = alternating(names, sides, problem.columns).contact
        found.append(replace(whole, contact=again, source="candidate"))
    passing = [p for p in found if passes(p.contact, problem, families)]
    if required and not passing:
        raise _unfit(original, problem, families, "alternating tripod")
    return passing


def _waves(
    problem: FootfallProblem, families: tuple[ConstraintSet, ...], travel: Travel, required: bool = False
) -> list[FootfallPattern]:
    """The wave of about as many columns as asked for, and a slower one, where they satisfy every family."""
    limbs = len(problem.locomotive_anywhere)
    if not limbs:
        return [] if not required else [solve(problem, families, SearchOptions())]
    swing = swing_columns_for(problem.columns, limbs)
    found = [best_wave(problem, travel, s) for s in (swing, swing + 1)]
    passing = [p for p in found if passes(p.contact, replace(problem, columns=p.columns), families)]
    if required and not passing:
        raise _unfit(found[0], replace(problem, columns=found[0].columns), families, "wave")
    return passing


def _program(
    problem: FootfallProblem, families: tuple[ConstraintSet, ...], travel: Travel, options: SearchOptions, limit: int,
    ranking: Ranking,
) -> list[FootfallPattern]:  # fmt: skip
    """Ties of the periodic program, each gait once, best first."""
    best = solve(problem, families, options)
    return list(ranked(ties(problem, families, best, options), problem, travel, ranking)[:limit])


def _unfit(
    pattern: FootfallPattern, problem: FootfallProblem, families: tuple[ConstraintSet, ...], name: str
) -> InfeasibleFootfall:
    """The exception for a method whose one pattern breaks a family."""
    broken = check_pattern(pattern.contact, problem, families)
    keys = tuple(dict.fromkeys(v.family for v in broken))
    limbs = {n for v in broken for n in v.limbs}
    text = f"The {name} of {', '.join(problem.locomotive_anywhere) or 'no limbs'} breaks {', '.join(keys)}."
    advice = "Use method=auto or method=program, or let other limbs walk."
    explain = {
        "families": list(keys),
        "limbs": [n for n in problem.limbs if n in limbs],
        "columns": sorted({j for v in broken for j in v.columns}),
        "text": f"{text} {broken[0].text}.",
        "advice": advice,
        "proof": "check",
        "demands": [d.as_dict() for d in demands_of(problem, families, keys, sorted(limbs))],
        "pattern": frame_of(problem),
    }
    return InfeasibleFootfall(f"{text} {broken[0].text}. {advice}", explain)


def _once(patterns: Iterable[FootfallPattern]) -> tuple[FootfallPattern, ...]:
    """Each gait once, the first of several equal ones kept."""
    kept: dict[tuple[int, bytes], FootfallPattern] = {}
    for pattern in patterns:
        kept.setdefault((pattern.columns, canonical(pattern.contact)), pattern)
    return tuple(kept.values())


__all__ = [
    "METHODS",
    "Method",
    "gait_pattern_candidates",
    "limbs_named",
    "synthesize_gait_pattern",
    "synthesize_transition_pattern",
    "transition_pattern_candidates",
]
