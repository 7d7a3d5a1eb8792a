"""Starts and stops of a run, with more time or less, and from another column, where the usual one does not do."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Literal

from gaitforge.errors import UnsolvedError
from gaitforge.motion.plan import MotionPlan
from gaitforge.pipeline.options import Options
from gaitforge.pipeline.search.refusals import why_refused
from gaitforge.pipeline.search.segment import Attempt, Segment
from gaitforge.pipeline.search.tries import unexplained
from gaitforge.pipeline.stopwatch import Stopwatch
from gaitforge.robot.model import RobotModel

STRETCHES = (1.0, 1.6, 2.4, 0.6, 0.25)
"""Factors on the time of a stand, tried in this order: more of it for slower joints, less of it for a shorter way,
where a limb that is locked stands in that of its neighbour"""
Which = Literal["start", "stop"]


def plan_stand(
    which: Which, robot: RobotModel, gait: MotionPlan, options: Options, watch: Stopwatch, name: str | None = None
) -> MotionPlan:
    """From rest into the gait, or from the gait to rest; raises `UnsolvedError` when no time is enough."""
    failure: UnsolvedError | None = None
    for stretch in STRETCHES:
        try:
            return _plan(which, robot, gait, options, watch, name or which, stretch)
        except UnsolvedError as error:
            failure = failure or error
            watch.progress("motion", f"{name or which}, {stretch:g} of the usual time: left ({error})")
    assert failure is not None
    raise failure


def plan_end(robot: RobotModel, gait: MotionPlan, options: Options, watch: Stopwatch, name: str) -> list[Segment]:
    """From the end of a gait's last cycle to rest; raises `UnsolvedError` when there is no way.

    Where there is none in the usual time, the gait goes on to a column from which there is: feet stay where they are
    while the body comes to rest, and what is in the way of a limb then is not in its way elsewhere in the cycle.
    Of several columns it is the one whose stop relaxes least, and of those the one that asks least of the motors.
    """
    from gaitforge.motion.failure.cut import begun
    from gaitforge.motion.rotate import rotated

    quick = replace(options, motion=unexplained(options.motion))
    left: list[Attempt] = []
    found: list[tuple[int, MotionPlan]] = []
    for column in range(gait.pattern.columns):
        begin = time.perf_counter()
        try:
            plan = _plan("stop", robot, rotated(gait, column) if column else gait, quick, watch, name, 1.0)
        except UnsolvedError as error:
            left.append(Attempt(f"{name} at column {column}", str(error), time.perf_counter() - begin))
            watch.progress("motion", f"{left[-1].what}: left ({error})")
            continue
        if column == 0:
            return [Segment(plan)]
        found.append((column, plan))
        if not plan.relaxed:
            break
    if not found:
        return [Segment(plan_stand("stop", robot, gait, options, watch, name))]
    column, plan = min(found, key=lambda one: (len(one[1].relaxed), float(one[1].report.details["effort_ratio"])))
    watch.progress("motion", f"{name}: the gait goes on to column {column} of {gait.pattern.columns}")
    return [Segment(begun(gait, column, f"{gait.name}_until_{name}")), Segment(plan, left=tuple(left))]


def _plan(
    which: Which, robot: RobotModel, gait: MotionPlan, options: Options, watch: Stopwatch, name: str, stretch: float
) -> MotionPlan:
    from gaitforge.motion.options import MotionOptions
    from gaitforge.motion.stand import plan_start, plan_stop

    motion = options.motion or MotionOptions()
    timed = replace(motion, stand_seconds=stretch * motion.stand_seconds)
    with watch.stage("motion"):
        plan = (plan_start if which == "start" else plan_stop)(robot, gait, name=name, options=timed)
    if why := why_refused(plan, options.refused):
        raise UnsolvedError(why)
    watch.progress("motion", f"{plan.name}: {plan.duration:.2f} s, {plan.report.seconds:.2f} s to solve")
    return plan
