"""Where a transition leaves one gait and enters another, judged with the feet where the gaits have them.

The footfall program knows nominal footholds.  A gait on few limbs stands elsewhere, its middle limbs far ahead say, and
then the order of steps decides whether a foot has to land where its neighbour still stands.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitforge.footfall.constraints import with_problem_families
from gaitforge.footfall.from_robot import transition_problem
from gaitforge.footfall.margin import stability
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.footfall.phases import optimum_of, with_seams
from gaitforge.footfall.placement.place import sectors_of
from gaitforge.footfall.ranking import AMPLE, GRAIN, SWAY, UNHURRIED, diverse
from gaitforge.footfall.search import SearchOptions, solve, ties
from gaitforge.footfall.solvers.segments import Segments
from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.rotate import rotated
from gaitforge.motion.state import gait_state
from gaitforge.motion.trajectory import planar_motion
from gaitforge.motion.transition import mean_command
from gaitforge.robot.model import RobotModel

Array = NDArray[np.float64]
APART = 0.065
"""[m] between two feet below which limbs are in each other's way; feet themselves are some 0.05 m wide"""
MOST_COLUMNS = 6
"""Columns of a gait at which it is left or entered: those at which something changes, thinned out evenly."""
TIES = 8
"""Patterns looked at between two columns."""


@dataclass(frozen=True, eq=False)
class Ends:
    """The feet and the centre of mass at both ends of a transition, in its own frame."""

    feet: tuple[Array, Array]
    """(n_F, 2) [m] each"""
    com: tuple[Array, Array]
    """(2,) [m] each"""


def meetings(
    robot: RobotModel, before: MotionPlan, after: MotionPlan, columns: int, column_s: float, limit: int, slack: int,
    footfall: Mapping[str, Any], leave: int | None = None,
) -> tuple[FootfallPattern, ...]:  # fmt: skip
    """Up to `limit` patterns between any two columns of the gaits, the best first; `info` says which columns.

    `leave`: the one column at which the first gait may be left.  Best are those in which no two feet have to be
    nearer than `APART`, the body has a place inside the feet at every switch, no foot hurries and the margin there is
    ample (up to `AMPLE`); then those with few changes.
    Raises `InfeasibleFootfall` when no two columns have a pattern between them, or `UnsolvedError`.
    """
    families = with_problem_families(footfall.get("constraints"))
    families = tuple(f for f in families if f is not sectors_of(families))
    options = SearchOptions(
        footfall.get("solver") or Segments(), footfall.get("seed", 0), footfall.get("time_limit_s", 10.0), sample=TIES
    )
    pairs = list(_pairs(before, after, leave))
    found: list[tuple[tuple[float, ...], FootfallPattern]] = []
    problems = {ab: transition_problem(robot, before.pattern, after.pattern, columns, *ab) for ab in pairs}
    for (a, b), problem in problems.items():
        contact = optimum_of(problem, families, options).contact
        if contact is None:
            continue
        best = FootfallPattern(contact, problem.limbs, False, "program")
        ends = ends_of(robot, rotated(before, a), rotated(after, b + 1), columns * column_s)
        for tie in ties(problem, families, best, options, slack):
            found.append((order(tie, ends, before.command.speed * column_s), with_seams(tie, problem)))
    if not found:  # says why, or that time ran out
        solve(problems[pairs[0]], families, options)
    return diverse([pattern for _, pattern in sorted(found, key=lambda item: item[0])], limit)


def _pairs(before: MotionPlan, after: MotionPlan, leave: int | None) -> Iterator[tuple[int, int]]:
    """(column that follows when the first gait is left, column that precedes when the second is entered)"""
    firsts: Iterable[int] = (leave,) if leave is not None else turning_points(before.pattern)
    for a in firsts:
        for b in turning_points(after.pattern):
            yield a, (b - 1) % after.pattern.columns


def turning_points(pattern: FootfallPattern) -> list[int]:
    """Columns that differ from the one before, at most `MOST_COLUMNS`; always column 0, where the gait may begin."""
    changed = (pattern.contact != np.roll(pattern.contact, 1, axis=1)).any(axis=0)
    changed[0] = True
    columns = np.flatnonzero(changed)
    if len(columns) > MOST_COLUMNS:
        columns = columns[np.arange(MOST_COLUMNS) * len(columns) // MOST_COLUMNS]
    return [int(column) for column in columns]


def ends_of(robot: RobotModel, before: MotionPlan, after: MotionPlan, seconds: float) -> Ends:
    """Feet and centre of mass when the first gait is left, and `seconds` later when the second is entered."""
    travel = planar_motion(mean_command(before.command, after.command), seconds)
    start, end = gait_state(robot, before), gait_state(robot, after, yaw=float(travel[2]))
    last = end.base.copy()
    last[:2] = start.base[:2] + travel[:2]
    feet = [robot.foot_positions(base, q)[:, :2] for base, q in ((start.base, start.joints), (last, end.joints))]
    com = [robot.center_of_mass(base, q)[:2] for base, q in ((start.base, start.joints), (last, end.joints))]
    return Ends((feet[0], feet[1]), (com[0], com[1]))


def order(pattern: FootfallPattern, ends: Ends, travel: float) -> tuple[float, ...]:
    """Sort key, smaller is better; `travel` [m] of the body in a column."""
    feet = foot_paths(pattern, ends)
    crowded = max(0.0, APART - nearest(feet))
    steps = np.linalg.norm(np.diff(feet, axis=1), axis=-1).max(initial=0.0)
    hurry = max(0.0, steps / max(travel, 1e-9) - UNHURRIED - 1.0)  # in the world a foot goes with the body, too
    share = (np.arange(pattern.columns + 1) / pattern.columns)[:, None]
    com = ends.com[0] + share * (ends.com[1] - ends.com[0])
    seen = np.stack([feet - com[None, :-1], feet - com[None, 1:]], axis=2)
    walking = pattern.contact.any(axis=1)
    sway = SWAY * float(np.linalg.norm(seen[walking].mean(axis=(1, 2)), axis=-1).mean()) if walking.any() else 0.0
    s = stability(pattern.contact, seen, np.zeros(2), sway, False, steps=5)
    margins = (-round(min(value, AMPLE) / GRAIN) for value in (s.switch_margin, s.margin))
    tips = max(0, -round(s.switch_margin / GRAIN))
    return (round(crowded / 0.005), tips, round(2 * hurry), *margins, pattern.changes, float(steps))


def foot_paths(pattern: FootfallPattern, ends: Ends) -> Array:
    """(n_F, m, 2) where each foot is in the middle of each column: where it stands, or on the way between.

    Between two steps of its own a foot stands half-way.
    """
    n, m = pattern.contact.shape
    paths = np.empty((n, m, 2))
    for i, row in enumerate(pattern.contact):
        air = np.flatnonzero(~row)
        if not len(air):
            paths[i] = ends.feet[0][i]
            continue
        steps = np.split(air, np.flatnonzero(np.diff(air) > 1) + 1)
        places = ends.feet[0][i] + np.linspace(0.0, 1.0, len(steps) + 1)[:, None] * (ends.feet[1][i] - ends.feet[0][i])
        paths[i] = places[np.cumsum([j in {s[0] for s in steps} for j in range(m)])]
        for k, step in enumerate(steps):
            done = (np.arange(len(step)) + 0.5) / len(step)
            paths[i, step] = places[k] + done[:, None] * (places[k + 1] - places[k])
    return paths


def nearest(paths: Array) -> float:
    """[m] the smallest distance between two feet."""
    apart = np.linalg.norm(paths[:, None] - paths[None], axis=-1)
    first, second = np.triu_indices(len(paths), 1)
    return float(apart[first, second].min(initial=np.inf))
