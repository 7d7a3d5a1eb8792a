"""Limp limbs out of the way: folded in a crouch, and hung from a body that stands higher."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from gaitforge.errors import UnsolvedError
from gaitforge.footfall.settling import MOST
from gaitforge.motion.plan import MotionPlan
from gaitforge.pipeline.failure.damage import Damage
from gaitforge.pipeline.failure.over_limp import unlifted
from gaitforge.pipeline.options import Options
from gaitforge.pipeline.search.refusals import why_refused
from gaitforge.pipeline.search.segment import Segment
from gaitforge.pipeline.search.tries import quick, unexplained
from gaitforge.pipeline.stopwatch import Stopwatch
from gaitforge.robot.model import RobotModel
from gaitforge.task.roles import Failed, Role

Array = NDArray[np.float64]
T = TypeVar("T")
Way = tuple[float, float]
"""How deep [m] and how long [s]"""
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
    from gaitforge.motion.failure.fold import CROUCHES, LATER, fold_groups, plan_fold
    from gaitforge.motion.failure.raised import raised

    limp = tuple(name for name, role in failed.items() if role.mode == "limp")
    as_it_lies = robot, dict(failed), stand, False
    if not limp or len(limp) < len(failed):
        return as_it_lies
    name, friction = stand.name.removesuffix("_halt"), options.search.limp_friction
    plans: list[MotionPlan] = []
    postures: dict[str, Array] = {}
    try:
        for number, group in enumerate(fold_groups(robot, stand, limp, friction)):
            called = f"{name}_fold{number + 1 if number else ''}"
            last = plans[-1] if plans else stand
            fold = partial(plan_fold, robot, last, roles, group, friction, name=called, options=options.motion)
            folded = _first(fold, LATER if plans else CROUCHES, lambda one: one.plans, options)
            plans += folded.plans
            postures |= folded.postures
    except UnsolvedError as error:
        watch.progress("motion", f"{name}: {', '.join(limp)} not folded ({error})")
        return as_it_lies
    higher = raised(robot, postures)
    if higher is None:
        watch.progress("motion", f"{name}: {', '.join(limp)} would not hang clear of the ground")
        return as_it_lies
    told = ", ".join(f"{n} at {np.round(q, 2).tolist()} rad" for n, q in postures.items())
    watch.progress("motion", f"{name}: folded {told}; the body stands {1e3 * higher.nominal.body_height:.0f} mm high")
    done.extend(Segment(plan) for plan in plans)
    hangs = {n: replace(failed[n], posture=tuple(q.tolist())) for n, q in postures.items()}
    return higher, {**failed, **hangs}, plans[-1], True


def rise(
    now: Damage, stand: MotionPlan, start: MotionPlan, watch: Stopwatch
) -> tuple[Damage, MotionPlan, list[Segment]]:
    """Where limp limbs touch the ground for long: steps are taken low, and the body rises after them, straight up.

    The robot with a low stance, the stand that its steps lead to, and what leads from there to where `start` begins;
    nothing of it where limp limbs hang clear, or there is no plan for it.
    """
    from gaitforge.motion.failure.fold import DIPS, plan_dip, plan_rise
    from gaitforge.motion.failure.raised import touches

    hangs = {n: np.array(role.posture) for n, role in now.roles.items() if role.mode == "limp"}
    if not now.hung or not touches(now.robot, hangs):
        return now, start, []
    height, low, name = float(stand.base_poses[-1, 2]), unlifted(now.options), f"{start.name}_rise"
    motion = unexplained(low.motion)
    motion = quick(motion) if len(start.pattern.locomotive) > MOST else motion
    try:
        with watch.stage("motion"):
            up = plan_rise(now.robot, start, height, name=name, options=motion)
            dip = partial(plan_dip, now.robot, start, name=f"{name}_dip", options=motion)
            plans = (up, *_first(dip, DIPS, tuple, now.options))
    except UnsolvedError as error:
        watch.progress("motion", f"{start.name}: no rise after the steps ({error})")
        return now, start, []
    posture = up.joint_positions[:, 0].copy()
    nominal = replace(now.robot.nominal, posture=posture, body_height=height)
    lower = replace(now, robot=replace(now.robot, nominal=nominal), options=low)
    return lower, up, [Segment(plan) for plan in plans]


def _first(
    plan: Callable[[Way], T], ways: Sequence[Way], plans: Callable[[T], Sequence[MotionPlan]], options: Options
) -> T:
    """The first of the ways that simulation has not refused; where it has refused all that have a plan, their first.

    Raises the `UnsolvedError` of the first where none has a plan.
    """
    found: list[T] = []
    failures: list[UnsolvedError] = []
    for way in ways:
        try:
            one = plan(way)
        except UnsolvedError as error:
            failures.append(error)
            continue
        if not any(why_refused(p, options.refused) for p in plans(one)):
            return one
        found.append(one)
    if not found:
        raise failures[0]
    return found[0]
