"""Limbs that fail on the way: the rest of the walk, the halt, and the robot that goes on with what is left."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from gaitforge.errors import UnsolvedError
from gaitforge.motion.plan import MotionPlan
from gaitforge.pipeline.failure.damage import Damage, kept_clear, stuck
from gaitforge.pipeline.failure.hung import hang_up
from gaitforge.pipeline.failure.over_limp import spaced
from gaitforge.pipeline.options import Options
from gaitforge.pipeline.search.gaits import nonlocomotive
from gaitforge.pipeline.search.refusals import first_allowed
from gaitforge.pipeline.search.segment import Segment
from gaitforge.pipeline.stopwatch import Stopwatch
from gaitforge.robot.model import RobotModel
from gaitforge.task.phase import Failure, Task
from gaitforge.task.roles import Failed, Role

HALTS = (1.0, 0.6, 1.6)
"""Factors on the time of a halt, in this order: 0.6 may catch a robot that tips while its feet are put down"""


def stretches(task: Task) -> Iterator[range]:
    """Runs of phases that end with a failure, or with the task."""
    first = 0
    for index, phase in enumerate(task.phases):
        if phase.failure is not None or index == len(task.phases) - 1:
            yield range(first, index + 1)
            first = index + 1


def at_speed(task: Task, span: range, share: float, robot: RobotModel) -> Task:
    """The task with the phases of `span` slower than asked for."""
    if share == 1.0:
        return task
    nominal = robot.nominal.speed
    phases = [
        replace(p, speed=share * (nominal if p.speed is None else p.speed)) if i in span else p
        for i, p in enumerate(task.phases)
    ]
    return replace(task, phases=tuple(phases))


def refuse_hopeless(robot: RobotModel, task: Task, options: Options) -> None:
    """Raise `InfeasibleFootfall` when no pattern at all can walk with the limbs that some failure leaves.

    Only the families that know nothing of geometry are asked (not g11): what clashes among them clashes wherever
    the limbs are stuck, so the proof needs no plan of what comes before.
    """
    from gaitforge.footfall.constraints import SupportSectors, with_problem_families
    from gaitforge.footfall.synthesis import gait_pattern_candidates

    families = with_problem_families(options.footfall.get("constraints"))
    timeless = tuple(f for f in families if not isinstance(f, SupportSectors))
    asked: dict[str, Any] = {**options.footfall, "constraints": timeless}
    lost: set[str] = set()
    for phase in task.phases:
        if lost and phase.gait in ("auto", "program"):
            free = lost | set(nonlocomotive(robot, phase, task.scene))
            walking = [n for n in robot.limb_names if n not in free]
            columns = robot.nominal.columns if phase.columns is None else phase.columns
            gait_pattern_candidates(robot, locomotive=walking, columns=columns, limit=1, **asked)
        lost.update(phase.failure.limbs if phase.failure is not None else ())


def plan_failure(now: Damage, gait: MotionPlan, failure: Failure, watch: Stopwatch, done: list[Segment]) -> Damage:
    """What follows a failure: the rest of the walk and the halt, added to `done`, and a stand clear of what failed.

    Where the others cannot stand alone, failed feet on the ground go on bearing load, and there is no such stand.
    Raises `UnsolvedError` when there is no plan for a halt.
    """
    from gaitforge.motion.failure.cut import begun
    from gaitforge.motion.failure.halt import CLEAR_M, lowest, plan_clear

    robot, name, motion = now.robot, gait.name, now.options.motion
    column = moment(robot, gait, failure, now.options.seed)
    until = begun(gait, column, f"{name}_until_failure") if column else gait
    if column:
        done.append(Segment(until))
    failed = {**now.roles, **_failed(robot, until, failure, now.options.search.limp_friction)}
    roles = {**gait.roles, **failed}
    watch.progress("motion", f"{name}: {', '.join(failure.limbs)} {failure.mode} at {column} of {gait.pattern.columns}")
    clear: MotionPlan | None = None
    with watch.stage("motion"):
        stand = _halted(robot, until, roles, now.options, f"{name}_halt")
        done.append(Segment(stand))
        held = tuple(n for n in failed if n in stand.pattern.locomotive)
        locked = tuple(n for n, role in failed.items() if role.mode == "locked")
        if lowest(robot, stand, locked) < CLEAR_M:
            try:
                clear = plan_clear(robot, stand, roles, name=f"{name}_clear", options=motion)
            except UnsolvedError as error:  # the others cannot stand alone where they are
                watch.progress("motion", f"{name}: {', '.join(held)} still bear load ({error})")
        robot, failed, stand, hung = hang_up(robot, stand, roles, failed, now.options, watch, done)
    damaged = stuck(robot, failed)
    options = kept_clear(damaged, failed, now.options)
    options = spaced(damaged, options, failed) if hung else options
    return Damage(damaged, options, failed, stand, clear, held, gait.pattern, hung)


def _halted(
    robot: RobotModel, until: MotionPlan, roles: Mapping[str, Role], options: Options, name: str
) -> MotionPlan:  # fmt: skip
    """The halt; where simulation has refused it, a quicker one, then a slower one."""
    from gaitforge.motion.failure.halt import plan_halt
    from gaitforge.motion.options import MotionOptions

    motion = options.motion or MotionOptions()
    halts = (
        plan_halt(robot, until, roles, name=name, options=replace(motion, stand_seconds=share * motion.stand_seconds))
        for share in HALTS
    )
    return first_allowed(halts, options.refused)


def moment(robot: RobotModel, gait: MotionPlan, failure: Failure, seed: int) -> int:
    """The column of the gait at whose start limbs fail; other limbs draw another one from the same seed."""
    columns = gait.pattern.columns
    if failure.at is not None:
        return int(failure.at * columns + 1e-9)
    which = sorted(robot.limb_names.index(robot.limb(n).name) for n in failure.limbs)
    return int(np.random.default_rng([seed, *which]).integers(columns))


def _failed(robot: RobotModel, until: MotionPlan, failure: Failure, friction: float) -> dict[str, Failed]:
    """Limb → its role from now on, with the posture that it has at the end of `until`, or comes to rest in."""
    from gaitforge.motion.failure.hanging import hanging_joints

    roles = {}
    for name in failure.limbs:
        limb = robot.limb(name)
        posture = until.joint_positions[robot.joint_indices(limb), -1]
        if failure.mode == "limp":
            posture = hanging_joints(robot, limb, posture, float(until.base_poses[-1, 2]), friction)
        roles[limb.name] = Failed(failure.mode, tuple(posture.tolist()))
    return roles
