"""A task's phases → stand, gait, transition, gait, …, stand."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from math import cos, sin

from gaitforge.errors import InfeasibleMotion, UnsolvedError
from gaitforge.motion.plan import Command, MotionPlan
from gaitforge.motion.trajectory import planar_motion
from gaitforge.pipeline.failure.damage import Damage
from gaitforge.pipeline.failure.event import at_speed, plan_failure, refuse_hopeless, stretches
from gaitforge.pipeline.failure.restart import plan_restart
from gaitforge.pipeline.handling import blocks, carriage
from gaitforge.pipeline.options import Options
from gaitforge.pipeline.search.gaits import nonlocomotive, plan_phase
from gaitforge.pipeline.search.segment import Attempt, Segment
from gaitforge.pipeline.search.stands import plan_end, plan_stand
from gaitforge.pipeline.search.transitions import meeting, plan_change
from gaitforge.pipeline.search.tries import Workers
from gaitforge.pipeline.stopwatch import Stopwatch
from gaitforge.robot.model import RobotModel
from gaitforge.task.phase import Phase, Task


def plan_task(robot: RobotModel, task: Task, options: Options, watch: Stopwatch, done: list[Segment]) -> None:
    """Plan every segment of the task, in the order of execution, into `done`.

    `done` is filled as far as planning came when an error leaves this function, so that the summary of
    a run without a solution shows what there was.
    """
    for block in blocks(task):
        own: list[Segment] = []
        try:
            _plan_block(robot, block, options, watch, own, tuple(done))
        finally:
            done += own


def _plan_block(
    robot: RobotModel, task: Task, options: Options, watch: Stopwatch, done: list[Segment], earlier: tuple[Segment, ...]
) -> None:
    """What is picked up, carried and put down; `earlier`: everything that is executed before."""
    with watch.stage("motion"):
        load = carriage(robot, task, _place(earlier))
        options = load.steadied(options)
    walk = load.walk
    refuse_hopeless(load.robot, walk, options)
    now, ends = Damage(load.robot, options), list[MotionPlan]()
    with Workers(options.search.workers) as workers:
        for span in stretches(walk):
            gaits = _plan_stretch(now, walk, span, watch, done, workers)
            ends += [gaits[0].plan, gaits[-1].plan]
            failure = walk.phases[span[-1]].failure
            if failure is not None:
                now = plan_failure(now, gaits[-1].plan, failure, watch, done)
                walk = now.applied(walk, span.stop)
    again = f"{ends[0].name}_" if earlier else ""
    start = plan_stand("start", load.robot, ends[0], options, watch, f"{again}start")
    end = plan_end(now.robot, ends[-1], now.options, watch, f"{again}stop")
    done[:] = load.around(robot, task.scene, [Segment(start), *done, *end], options, watch, earlier)


def _place(earlier: Sequence[Segment]) -> tuple[float, float, float]:
    """x, y [m], yaw [rad] of the base after segments; the origin of the world before any."""
    if not earlier:
        return 0.0, 0.0, 0.0
    from gaitforge.motion.timeline_build import laid_out, last_pose

    x, y, _, _, _, yaw = last_pose(laid_out([(s.plan, s.cycles) for s in earlier])[-1])
    return float(x), float(y), float(yaw)


def _plan_stretch(
    now: Damage, task: Task, span: range, watch: Stopwatch, done: list[Segment], workers: Workers
) -> list[Segment]:
    """The gaits of phases between which nothing fails; they and what joins them are added to `done`.

    After a failure the others may be slower than they were told: what was tried before stands with the first gait.
    """
    before, begin = len(done), time.perf_counter()
    left: list[Attempt] = []
    for share in now.speeds:
        del done[before:]
        slower = at_speed(task, span, share, now.robot)
        try:
            gaits = _plan_gaits(now, slower, span, watch, done, workers)
            changes = _plan_changes(now.robot, gaits, now.options, watch, workers)
            into = plan_restart(now, gaits[0].plan, watch, workers)
            break
        except (UnsolvedError, InfeasibleMotion) as error:
            if share == now.speeds[-1]:
                raise
            left.append(Attempt(f"{share:.0%} of the speed", str(error), time.perf_counter() - begin))
            watch.progress("motion", f"{share:.0%} of the speed: left ({error})")
    gaits[0] = replace(gaits[0], left=(*left, *gaits[0].left))
    between = [segment for pair in zip(gaits[1:], changes, strict=True) for segment in reversed(pair)]
    done[before:] = [*into, gaits[0], *between]
    return gaits


def _plan_changes(
    robot: RobotModel, gaits: list[Segment], options: Options, watch: Stopwatch, workers: Workers
) -> list[Segment]:
    """The transitions between the gaits, which are begun where they meet.

    With the best pair of phases only the first gait may be left anywhere: the others go on for whole
    cycles from where they were entered.
    """
    best = options.search.transition_phases == "best"
    changes: list[Segment] = []
    for index in range(len(gaits) - 1):
        before, after = gaits[index], gaits[index + 1]
        leave = 0 if best and index else None
        changes.append(plan_change(robot, before.plan, after.plan, options, watch, workers, leave))
        met = meeting(before.plan, after.plan, changes[-1].plan.pattern, options)
        gaits[index], gaits[index + 1] = replace(before, plan=met[0]), replace(after, plan=met[1])
    return changes


def _plan_gaits(
    now: Damage, task: Task, span: range, watch: Stopwatch, done: list[Segment], workers: Workers
) -> list[Segment]:
    """The gaits in order; a phase that asks for the gait of the phase before it goes on with it."""
    robot, before, known = now.robot, len(done), list[tuple[Phase, MotionPlan]]()
    for index in span:
        phase = task.phases[index]
        if index > span[0] and _same_gait(robot, task, task.phases[index - 1], phase):
            done[-1] = replace(done[-1], cycles=done[-1].cycles + phase.cycles)
            continue
        again = next((plan for other, plan in known if _same_gait(robot, task, other, phase)), None)
        if again is None:
            there, original = (
                _middle(robot, task.phases, index),
                done[-1].plan.pattern if done[before:] else now.pattern,
            )
            done.append(plan_phase(robot, phase, task.scene, now.options, watch, there, original, workers))
        else:
            done.append(Segment(replace(again, name=phase.name), phase.cycles))
        known.append((phase, done[-1].plan))
    return done[before:]


def _middle(robot: RobotModel, phases: Sequence[Phase], index: int) -> tuple[float, float, float]:
    """x, y [m], yaw [rad] of the base about the middle of a phase, by the commands up to there."""
    nominal = robot.nominal
    x = y = yaw = 0.0
    for number, phase in enumerate(phases[: index + 1]):
        speed = nominal.speed if phase.speed is None else phase.speed
        seconds = phase.cycles * (nominal.duration if phase.duration in (None, "auto") else float(phase.duration))
        seconds *= 0.5 if number == index else 1.0
        seconds += nominal.transition_columns * nominal.transition_column_s if number else 0.0
        dx, dy, turn = planar_motion(Command(speed, phase.heading, phase.yaw_rate), seconds)
        x, y = x + cos(yaw) * dx - sin(yaw) * dy, y + sin(yaw) * dx + cos(yaw) * dy
        yaw += float(turn)
    return float(x), float(y), yaw


def _same_gait(robot: RobotModel, task: Task, one: Phase, other: Phase) -> bool:
    def asked(phase: Phase) -> Phase:
        return replace(phase, name="", cycles=0, roles=nonlocomotive(robot, phase, task.scene))

    return asked(one) == asked(other)
