"""A task's phases → stand, gait, transition, gait, …, stand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import cos, sin

from gaitforge.motion.plan import Command, MotionPlan
from gaitforge.motion.trajectory import planar_motion
from gaitforge.pipeline.gaits import nonlocomotive, plan_phase
from gaitforge.pipeline.handling import carriage
from gaitforge.pipeline.options import Options
from gaitforge.pipeline.segment import Segment
from gaitforge.pipeline.stopwatch import Stopwatch
from gaitforge.pipeline.transitions import meeting, plan_change
from gaitforge.pipeline.tries import Workers
from gaitforge.robot.model import RobotModel
from gaitforge.task.phase import Phase, Task


def plan_task(robot: RobotModel, task: Task, options: Options, watch: Stopwatch, done: list[Segment]) -> None:
    """Plan every segment of the task, in the order of execution, into `done`.

    `done` is filled as far as planning came when an error leaves this function, so that the summary of
    a run without a solution shows what there was.
    """
    with watch.stage("motion"):
        load = carriage(robot, task)
    laden, walk = load.robot, load.walk
    with Workers(options.search.workers) as workers:
        gaits = _plan_gaits(laden, walk, options, watch, done, workers)
        changes = _plan_changes(laden, gaits, options, watch, workers)
    start, stop = (
        Segment(_stand(w, laden, g.plan, options, watch)) for w, g in (("start", gaits[0]), ("stop", gaits[-1]))
    )
    between = [segment for pair in zip(gaits[1:], changes, strict=True) for segment in reversed(pair)]
    done[:] = load.around(robot, task.scene, [start, gaits[0], *between, stop], watch)


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
    robot: RobotModel, task: Task, options: Options, watch: Stopwatch, done: list[Segment], workers: Workers
) -> list[Segment]:
    """The gaits in order; a phase that asks for the gait of the phase before it goes on with it."""
    known: list[tuple[Phase, MotionPlan]] = []
    for index, phase in enumerate(task.phases):
        if index and _same_gait(robot, task, task.phases[index - 1], phase):
            done[-1] = replace(done[-1], cycles=done[-1].cycles + phase.cycles)
            continue
        again = next((plan for other, plan in known if _same_gait(robot, task, other, phase)), None)
        if again is None:
            there, original = _middle(robot, task.phases, index), done[-1].plan.pattern if done else None
            done.append(plan_phase(robot, phase, task.scene, options, watch, there, original, workers))
        else:
            done.append(Segment(replace(again, name=phase.name), phase.cycles))
        known.append((phase, done[-1].plan))
    return list(done)


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


def _stand(which: str, robot: RobotModel, gait: MotionPlan, options: Options, watch: Stopwatch) -> MotionPlan:
    from gaitforge.motion.stand import plan_start, plan_stop

    plan_stand = plan_start if which == "start" else plan_stop
    with watch.stage("motion"):
        plan = plan_stand(robot, gait, options=options.motion)
    watch.progress("motion", f"{plan.name}: {plan.duration:.2f} s, {plan.report.seconds:.2f} s to solve")
    return plan
