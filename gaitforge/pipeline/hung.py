"""Limp limbs out of the way: folded in a crouch, and hung from a body that stands higher."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from gaitforge.errors import UnsolvedError
from gaitforge.motion.plan import MotionPlan
from gaitforge.pipeline.damage import Damage
from gaitforge.pipeline.options import Options
from gaitforge.pipeline.segment import Segment
from gaitforge.pipeline.stopwatch import Stopwatch
from gaitforge.robot.model import RobotModel
from gaitforge.task.roles import Failed, Role

CLEARANCE_M = 0.01
"""[m] kept between bodies once limbs hang limp: they swing, and friction holds them a little beside their place"""
Hung = tuple[RobotModel, dict[str, Failed], MotionPlan, bool]
"""The robot with its higher stance, failed limbs as they hang, the stand after which it walks on; whether they hang"""


def hang_up(
    robot: RobotModel, stand: MotionPlan, roles: Mapping[str, Role], failed: Mapping[str, Failed], options: Options,
    watch: Stopwatch, done: list[Segment],
) -> Hung:  # fmt: skip
    """What takes limp limbs off the ground is added to `done`; where nothing does, they lie where they are.

    Limbs that are locked are not folded, and keep the body from coming down: with one of them among those that
    failed, nothing is done.
    """
    from gaitforge.motion.failure.fold import plan_fold
    from gaitforge.motion.failure.raised import raised

    limp = tuple(name for name, role in failed.items() if role.mode == "limp")
    as_it_lies = robot, dict(failed), stand, False
    if not limp or len(limp) < len(failed):
        return as_it_lies
    name, friction = stand.name.removesuffix("_halt"), options.search.limp_friction
    try:
        folded = plan_fold(robot, stand, roles, limp, friction, name=f"{name}_fold", options=options.motion)
    except UnsolvedError as error:
        watch.progress("motion", f"{name}: {', '.join(limp)} not folded ({error})")
        return as_it_lies
    higher = raised(robot, folded.postures)
    if higher is None:
        watch.progress("motion", f"{name}: {', '.join(limp)} would not hang clear of the ground")
        return as_it_lies
    told = ", ".join(f"{n} at {np.round(q, 2).tolist()} rad" for n, q in folded.postures.items())
    watch.progress("motion", f"{name}: folded {told}; the body stands {1e3 * higher.nominal.body_height:.0f} mm high")
    done.extend(Segment(plan) for plan in folded.plans)
    hangs = {n: replace(failed[n], posture=tuple(q.tolist())) for n, q in folded.postures.items()}
    return higher, {**failed, **hangs}, folded.plans[-1], True


def spaced(options: Options, roles: Mapping[str, Failed]) -> Options:
    """The options with more room between bodies where limbs hang limp."""
    from gaitforge.motion.options import MotionOptions

    if not any(role.mode == "limp" for role in roles.values()):
        return options
    motion = options.motion or MotionOptions()
    return replace(options, motion=replace(motion, clearance=max(motion.clearance, CLEARANCE_M)))


def rise(
    now: Damage, stand: MotionPlan, start: MotionPlan, watch: Stopwatch
) -> tuple[Damage, MotionPlan, list[Segment]]:
    """Where limp limbs touch the ground for long: steps are taken low, and the body rises after them, straight up.

    The robot with a low stance, the stand that its steps lead to, and what leads from there to where `start` begins;
    nothing of it where limp limbs hang clear, or there is no plan for it.
    """
    from gaitforge.motion.failure.fold import plan_rise
    from gaitforge.motion.failure.raised import touches

    hangs = {n: np.array(role.posture) for n, role in now.roles.items() if role.mode == "limp"}
    if not now.hung or not touches(now.robot, hangs):
        return now, start, []
    height = float(stand.base_poses[-1, 2])
    try:
        with watch.stage("motion"):
            plans = plan_rise(now.robot, start, height, name=f"{start.name}_rise", options=now.options.motion)
    except UnsolvedError as error:
        watch.progress("motion", f"{start.name}: no rise after the steps ({error})")
        return now, start, []
    posture = plans[0].joint_positions[:, 0].copy()
    nominal = replace(now.robot.nominal, posture=posture, body_height=height)
    return replace(now, robot=replace(now.robot, nominal=nominal)), plans[0], [Segment(plan) for plan in plans]
