"""A task is planned, simulated, and planned again without what the simulator refused."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from gaitforge.errors import InfeasibleError, UnsolvedError
from gaitforge.pipeline.options import Options
from gaitforge.pipeline.schedule import plan_task
from gaitforge.pipeline.search.refusals import refused, why_refused
from gaitforge.pipeline.search.segment import Segment
from gaitforge.pipeline.stopwatch import Stopwatch
from gaitforge.robot.model import RobotModel
from gaitforge.task.phase import Task
from gaitforge.verify.verdict import Verdict

Execute = Callable[[Sequence[Segment]], Verdict]


@dataclass(frozen=True, eq=False)
class Proven:
    """What was planned, and what simulation made of it."""

    segments: tuple[Segment, ...]
    verdict: Verdict
    verdicts: tuple[Verdict, ...]
    """On every plan that was made, in order; `verdict` is one of them"""


def proven(
    robot: RobotModel, task: Task, options: Options, watch: Stopwatch, done: Sequence[Segment], execute: Execute
) -> Proven:
    """The verdict of `execute` on a planned task, or on what takes its place.

    Segments that fail are refused, and the task is planned again without them, up to `search.replans` times, as long
    as there is something to take the place of any: the first plan that passes is kept, else the one with the fewest
    failed checks.  Plans of equation (3) are judged as they are.
    """
    plans, verdict = tuple(done), execute(done)
    verdicts, best = [verdict], (plans, verdict)
    for turn in range(options.search.replans if options.transition == "optimise" else 0):
        fresh = [r for r in refused(verdict, plans, options.refused) if r not in options.refused]
        if verdict.passed or not fresh:
            break
        for one in fresh:
            watch.progress("verify", f"{one.segment} is {one.why}: planned again ({turn + 1})")
        options = replace(options, refused=(*options.refused, *fresh))
        other: list[Segment] = []
        try:
            plan_task(robot, task, options, watch, other)
        except (UnsolvedError, InfeasibleError) as error:
            watch.progress("verify", f"nothing to take its place ({error})")
            break
        again = [s.plan.name for s in other if why_refused(s.plan, options.refused)]
        if again:
            watch.progress("verify", f"nothing to take the place of {', '.join(again)}")
        if {one.segment for one in fresh} <= {*again}:
            break
        plans, verdict = tuple(other), execute(other)
        verdicts.append(verdict)
        best = min(best, (plans, verdict), key=lambda one: len(one[1].failed))
    return Proven(*best, tuple(verdicts))
