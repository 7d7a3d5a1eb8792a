"""The cascade for a transition: patterns, numbers of columns and column times until one has a motion plan."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice

from gaitforge.errors import InfeasibleFootfall, UnsolvedError
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import MotionPlan
from gaitforge.pipeline.options import Options
from gaitforge.pipeline.search.batch import run_batch
from gaitforge.pipeline.search.segment import Attempt, Segment, exhausted
from gaitforge.pipeline.search.tries import Try, Workers, unexplained, why
from gaitforge.pipeline.stopwatch import Stopwatch
from gaitforge.robot.model import RobotModel

SECOND_LOOKS = 4
"""Batches of tries at a transition that are made after one whose plan tips, or is more than the motors hold"""


def plan_change(
    robot: RobotModel, before: MotionPlan, after: MotionPlan, options: Options, watch: Stopwatch,
    workers: Workers | None = None, leave: int | None = None,
) -> Segment:  # fmt: skip
    """The transition from one gait into another; `leave`: the one column at which the first may be left.

    With the best pair of phases the plan joins the gaits as `meeting` turns them.
    Tries are made in batches; of the first batch in which any has a plan, the cheapest is taken, if need be with
    bounds on the motors' efforts (`spared`).  Where it is not sound (`_Found`), up to `SECOND_LOOKS` more batches are
    asked for one that is.
    Raises `InfeasibleFootfall` when no number of columns has a pattern, `UnsolvedError` when no try had a plan.
    """
    from gaitforge.motion.transition import plan_transition

    name = f"{before.name}_to_{after.name}"
    if options.transition == "interpolate":
        with watch.stage("motion"):
            return Segment(plan_transition(robot, before, after, method="interpolate", name=name))
    workers = workers or Workers()
    attempts: list[Attempt] = []
    tries = (
        _try(robot, before, after, pattern, column_s, name, options)
        for pattern, column_s in _tries(robot, before, after, name, options, watch, attempts, leave)
    )
    found: list[_Found] = []
    first: Try | None = None
    looks = 0
    while looks <= SECOND_LOOKS and (batch := list(islice(tries, options.search.transition_batch))):
        done = run_batch(batch, name, options, watch, workers)
        attempts += done.left
        if not done.tries:
            continue
        first = first or done.tries[0]
        if (taken := done.taken) is not None:
            assert taken.plan is not None
            found.append(_Found.of(robot, taken.what, taken.plan, taken.seconds, options.motion or MotionOptions()))
            if found[-1].sound:
                break
        looks += bool(found)
    if found:
        return _soundest(name, found, attempts, watch)
    with watch.stage("motion"):
        known = why(first)
    reason = f": {known['text']}" if known.get("text") else ""
    raise UnsolvedError(
        f"transition {name}: none of {len(attempts)} tries has a plan{reason}", exhausted(name, attempts, known)
    )


@dataclass(frozen=True, eq=False)
class _Found:
    """A plan, and whether it will do in the real world."""

    what: str
    plan: MotionPlan
    seconds: float
    margin: float
    """[m] of centre of mass and of zero-moment point inside the feet, the latter by inverse dynamics"""
    strain: float
    """[-] above 1 no contact forces let the motors hold it (`strain_of`)"""
    push: float
    """[m] that the ground pushes feet up between samples, if that is more than was aimed for and a grid that is finer
    may be had: on the finest one others do no better"""

    @staticmethod
    def of(robot: RobotModel, what: str, plan: MotionPlan, seconds: float, options: MotionOptions) -> _Found:
        from gaitforge.motion.still import static_margin
        from gaitforge.motion.strain import strain_of

        margin = min(float(plan.report.details.get("zmp_margin_m", 0.0)), static_margin(robot, plan))
        deep, most = (float(plan.report.details.get(f"{key}_m", 0.0)) for key in ("penetration", "ground_tolerance"))
        push = deep if deep > most and plan.samples_per_column < options.finest else 0.0
        return _Found(what, plan, seconds, margin, strain_of(robot, plan), push)

    @property
    def sound(self) -> bool:
        """Neither tips, nor gives way, nor rocks."""
        return self.margin >= 0.0 and self.strain <= 1.0 and self.push == 0.0

    @property
    def rank(self) -> tuple[bool, float, float, float]:
        """The larger the better: what tips falls, what gives way limps, what is pushed rocks."""
        return self.margin >= 0.0, -max(self.strain, 1.0), min(self.margin, 0.0), -self.push

    @property
    def left(self) -> Attempt:
        """The entry of a plan that was left."""
        tips = f"{-1e3 * self.margin:.1f} mm outside the feet" if self.margin < 0.0 else ""
        weak = f"{self.strain:.2f} of the motors' efforts" if self.strain > 1.0 else ""
        rocks = f"feet {1e3 * self.push:.1f} mm in the ground" if self.push > 0.0 else ""
        return Attempt(self.what, ", ".join(filter(None, (tips, weak, rocks))), self.seconds)


def _soundest(name: str, found: list[_Found], attempts: list[Attempt], watch: Stopwatch) -> Segment:
    best = max(reversed(found), key=lambda one: one.rank)
    watch.progress("motion", f"{name}: {best.what}, {best.plan.report.seconds:.2f} s to solve")
    return Segment(best.plan, 1, (*attempts, *(one.left for one in found if one is not best)))


def _try(
    robot: RobotModel, before: MotionPlan, after: MotionPlan, pattern: FootfallPattern, column_s: float, name: str,
    options: Options,
) -> Try:  # fmt: skip
    what = f"{pattern.columns} columns of {column_s:.3f} s, {pattern.changes} changes"
    named = {"pattern": pattern, "column_s": column_s, "name": name, "options": unexplained(options.motion)}
    return Try(what, "transition", robot, meeting(before, after, pattern, options), named)


def meeting(
    before: MotionPlan, after: MotionPlan, transition: FootfallPattern, options: Options
) -> tuple[MotionPlan, MotionPlan]:
    """Both gaits begun where the transition leaves the one and enters the other (their own seams, but for *best*)."""
    from gaitforge.motion.rotate import rotated

    info = transition.info
    if options.search.transition_phases != "best" or "from_column" not in info:
        return before, after
    left = rotated(before, info["from_column"]) if before.kind == "gait" else before
    return left, rotated(after, info["to_column"] + 1)


def _tries(
    robot: RobotModel, before: MotionPlan, after: MotionPlan, name: str, options: Options, watch: Stopwatch,
    attempts: list[Attempt], leave: int | None,
) -> Iterator[tuple[FootfallPattern, float]]:  # fmt: skip
    """(pattern, column time [s]): the best of every timing before the second best of any."""
    search, nominal = options.search, robot.nominal
    found: dict[int, tuple[FootfallPattern, ...]] = {}
    refusals: list[InfeasibleFootfall] = []
    for rank in range(search.transition_candidates):
        for stretch in search.transition_stretch:
            for extra in search.transition_columns:
                columns = nominal.transition_columns + extra
                if columns not in found:
                    found[columns] = _patterns(
                        robot, before, after, columns, name, options, watch, attempts, refusals, leave
                    )
                if rank < len(found[columns]):
                    yield found[columns][rank], nominal.transition_column_s * stretch
    if refusals and not any(found.values()):
        raise refusals[0]


def _patterns(
    robot: RobotModel, before: MotionPlan, after: MotionPlan, columns: int, name: str, options: Options,
    watch: Stopwatch, attempts: list[Attempt], refusals: list[InfeasibleFootfall], leave: int | None,
) -> tuple[FootfallPattern, ...]:  # fmt: skip
    from gaitforge.footfall.synthesis import transition_pattern_candidates
    from gaitforge.pipeline.search.seams import meetings

    begin = time.perf_counter()
    search = options.search
    limit, slack = search.transition_candidates, search.transition_slack
    try:
        with watch.stage("footfall"):
            if search.transition_phases == "best":
                column_s = robot.nominal.transition_column_s
                found = meetings(robot, before, after, columns, column_s, limit, slack, options.footfall, leave)
            else:
                found = transition_pattern_candidates(
                    robot, before.pattern, after.pattern, columns=columns, limit=limit, from_column=leave, slack=slack,
                    phases=search.transition_phases, **options.footfall,
                )  # fmt: skip
    except (InfeasibleFootfall, UnsolvedError) as error:
        attempts.append(Attempt(f"pattern of {columns} columns", str(error), time.perf_counter() - begin))
        if isinstance(error, InfeasibleFootfall):
            refusals.append(error)
        return ()
    watch.progress("footfall", f"{name}: {len(found)} patterns of {columns} columns")
    return found
