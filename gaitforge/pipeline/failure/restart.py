"""Walking on after a failure: feet are put where the new gait begins, and it is begun from rest."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gaitforge.errors import UnsolvedError
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.footfall.settling import MOST
from gaitforge.motion.plan import MotionPlan
from gaitforge.pipeline.failure.damage import Damage
from gaitforge.pipeline.failure.hung import rise
from gaitforge.pipeline.options import Options
from gaitforge.pipeline.search.refusals import allowed
from gaitforge.pipeline.search.segment import Attempt, Segment, exhausted
from gaitforge.pipeline.search.stands import plan_stand
from gaitforge.pipeline.search.transitions import plan_change
from gaitforge.pipeline.search.tries import Try, Workers, attempt, quick, unexplained
from gaitforge.pipeline.stopwatch import Stopwatch

Array = NDArray[np.float64]
UNHURRIED = (1.6, 2.4)
"""Factors on the robot's nominal time of a column for steps that are taken one by one."""
AMPLE_M = 0.008
"""[m] that centre of mass and zero-moment point stay inside the feet: with less, other orders of steps are tried"""
LOW_M = 0.012
"""[m] high steps while failed feet still bear load: what is lifted with the body need not be lifted higher"""


def plan_restart(now: Damage, gait: MotionPlan, watch: Stopwatch, workers: Workers) -> list[Segment]:
    """From the halt after a failure into a gait; nothing before anything has failed.

    Feet are put down elsewhere once the failed ones are off the ground, or while these bear load, where only that
    has a plan.  Raises `UnsolvedError` when neither has.
    """
    failure: UnsolvedError | None = None
    for one, stand in _ways(now, gait):
        if failure is not None:
            what = f"{', '.join(one.held)} bear load" if one.held else "no failed foot bears load"
            watch.progress("motion", f"{what} while the others step ({failure})")
        try:
            steps = _steps(one, stand, gait, watch, workers)
            return [Segment(stand), *steps] if stand is now.clear else steps
        except UnsolvedError as error:
            failure = error
    if failure is not None:
        raise failure
    return []


def _ways(now: Damage, gait: MotionPlan) -> Iterator[tuple[Damage, MotionPlan]]:
    """The robot, and the stand from which its limbs step; the best way first.

    Where failed feet may bear load, many limbs that step without them are given up early, and all of their tries are
    made only when there is nothing else left: from a stand that is too low for a limb none of them has a plan.
    """
    if now.stand is None:
        return
    free = replace(now, held=())
    many = len(gait.pattern.locomotive) > MOST
    if now.clear is not None:
        yield (_hasty(free) if now.held and many else free), now.clear
    if now.clear is None or now.held:
        yield now, now.stand
    if now.clear is not None and now.held and many:
        yield free, now.clear


def _hasty(now: Damage) -> Damage:
    """The same with few tries at a transition, none of them by a slow second solver."""
    from gaitforge.motion.options import MotionOptions

    search = now.options.search
    few = replace(search, transition_candidates=1, transition_stretch=search.transition_stretch[:1])
    motion = quick(now.options.motion or MotionOptions())
    return replace(now, options=replace(now.options, search=few, motion=motion))


def _steps(now: Damage, stand: MotionPlan, gait: MotionPlan, watch: Stopwatch, workers: Workers) -> list[Segment]:
    """From a stand into a gait: few limbs step one by one, in the order with the best margin, many as always."""
    from gaitforge.motion.options import MotionOptions
    from gaitforge.motion.still import quiet

    start = plan_stand("start", now.robot, gait, now.options, watch, f"{gait.name}_start")
    at_rest = replace(start, command=replace(start.command, speed=0.0, yaw_rate=0.0))
    now, at_rest, risen = rise(now, stand, at_rest, watch)
    if len(gait.pattern.locomotive) <= MOST:
        return [_settled(now, stand, at_rest, watch), *risen, Segment(start)]
    search = replace(now.options.search, transition_phases="seam")
    options = _while_held(now)
    options = replace(options, search=search, motion=quiet(options.motion or MotionOptions()))
    return [plan_change(now.robot, stand, at_rest, options, watch, workers), *risen, Segment(start)]


def _settled(now: Damage, stand: MotionPlan, start: MotionPlan, watch: Stopwatch) -> Segment:
    """From stand to stand, step by step: the first plan with an ample margin, else the one with the largest.

    The margin is the smaller one of the centre of mass and of the zero-moment point by inverse dynamics.
    """
    from gaitforge.motion.still import static_margin

    name, begin = f"{stand.name}_to_{start.name}", time.perf_counter()
    left: list[Attempt] = []
    narrow: list[tuple[float, MotionPlan]] = []
    for one in _tries(now, stand, start, name):
        if barred := allowed([one], now.options.refused)[1]:
            left += barred
            continue
        with watch.stage("motion"):
            result = attempt(one)
        if result.plan is None:
            left.append(result.left)
            watch.progress("motion", f"{name}: {one.what}: left ({left[-1].why})")
            continue
        margin = min(float(result.plan.report.details["zmp_margin_m"]), static_margin(now.robot, result.plan))
        watch.progress("motion", f"{name}: {one.what}, margin {1000 * margin:.0f} mm, {result.seconds:.2f} s")
        if margin >= AMPLE_M:
            return Segment(result.plan, 1, tuple(left))
        narrow.append((margin, result.plan))
        left.append(Attempt(one.what, f"margin {1000 * margin:.1f} mm", result.seconds))
    if narrow:
        return Segment(max(narrow, key=lambda found: found[0])[1], 1, tuple(left))
    raise UnsolvedError(
        f"{name}: none of {len(left)} tries has a plan in {time.perf_counter() - begin:.1f} s", exhausted(name, left)
    )


def _tries(now: Damage, stand: MotionPlan, start: MotionPlan, name: str) -> Iterator[Try]:
    """Steps with the centre of mass over the feet, slower ones, and last those that only keep the CoP there."""
    from gaitforge.motion.options import MotionOptions
    from gaitforge.motion.still import stepping

    motion = quick(_while_held(now).motion or MotionOptions())
    patterns = _patterns(now, stand, start)
    for how, options in (("", stepping(motion)), (", swaying", motion)):
        for stretch in UNHURRIED:
            column_s = now.robot.nominal.transition_column_s * stretch
            for pattern in patterns:
                what = f"steps {' '.join(pattern.info['order'])}, {column_s:.3f} s a column{how}"
                named = {"pattern": pattern, "column_s": column_s, "name": name, "options": unexplained(options)}
                yield Try(what, "transition", now.robot, (stand, start), named)


def _patterns(now: Damage, stand: MotionPlan, start: MotionPlan) -> tuple[FootfallPattern, ...]:
    from gaitforge.footfall.settling import settling_patterns

    before, after = (_from_body(plan, k) for plan, k in ((stand, -1), (start, 0)))
    feet, centers = (before[0], after[0]), (before[1], after[1])
    return settling_patterns(now.robot.limb_names, start.pattern.locomotive, now.held, feet, centers)


def _from_body(plan: MotionPlan, k: int) -> tuple[Array, Array]:
    """Feet (n_F, 2) and centre of mass (2,) at sample k [m], seen from the body's place and heading."""
    base = plan.base_poses[k]
    c, s = np.cos(base[5]), np.sin(base[5])
    turn = np.array([[c, -s], [s, c]])  # world → body when multiplied from the right
    return (plan.feet[k, :, :2] - base[:2]) @ turn, (plan.com[k, :2] - base[:2]) @ turn


def _while_held(now: Damage) -> Options:
    """Options for steps during which failed feet on the ground bear load: they are locked, and lifted at the end."""
    from gaitforge.motion.constraints.locked import Locked
    from gaitforge.motion.constraints.off_ground import OffGround
    from gaitforge.motion.options import MotionOptions

    if not now.held:
        return now.options
    motion = now.options.motion or MotionOptions()
    families = [
        replace(f, points=tuple(p for p in f.points if p[0] not in now.held)) if isinstance(f, OffGround) else f
        for f in motion.constraints
    ]
    held = replace(motion, constraints=(*families, Locked(limbs=now.held)), step_height=LOW_M)
    return replace(now.options, motion=held)
