"""After limbs have failed: a halt on all feet that are left, and a stand that lifts the failed ones off the ground."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from gaitforge.errors import UnsolvedError
from gaitforge.footfall.given import stand_pattern
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion.constraints.balance import Balance
from gaitforge.motion.constraints.locked import Locked
from gaitforge.motion.constraints.off_ground import OffGround, Point
from gaitforge.motion.failure.late import LateBalance
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import Command, MotionPlan
from gaitforge.motion.segment import Segment
from gaitforge.motion.solve import solve_segment
from gaitforge.motion.state import end_state, rest_state
from gaitforge.motion.trajectory import Boundary, Discretisation, Guess
from gaitforge.robot.model import RobotModel
from gaitforge.task.roles import Failed, Role

Array = NDArray[np.float64]
COLUMNS = 4
LANDING = 2
"""[columns] in which feet that are in the air are put down"""
CLEAR_M = 0.01
"""[m] that a foot which cannot be lifted any more is off the ground"""
SPARE_M = 0.002
"""[m] more, where the stand ends: what follows keeps `CLEAR_M`"""
CATCH = 0.25
"""Of `stand_seconds`, for a halt that has to be quick"""
SHARES = (0.5, 0.3, 0.1)
"""Shares by which the support polygon is shrunk: a body that stands may be nearer to its edge than one that walks."""


def foot_points(robot: RobotModel, limbs: tuple[str, ...], joints: Array) -> tuple[Point, ...]:
    """Feet of limbs whose joints stay as they are, fixed in the base frame [m]."""
    feet = robot.foot_positions(np.zeros(6), joints)
    points = []
    for limb, (x, y, z) in zip(robot.limbs, feet.tolist(), strict=True):
        if limb.name in limbs:
            points.append((limb.name, (x, y, z), limb.foot.radius))
    return tuple(points)


def lowest(robot: RobotModel, plan: MotionPlan, limbs: tuple[str, ...]) -> float:
    """[m] the lowest of these limbs' feet is above the ground where the plan ends; inf without limbs."""
    heights = [plan.feet[-1, i, 2] - x.foot.radius for i, x in enumerate(robot.limbs) if x.name in limbs]
    return float(min(heights, default=np.inf))


def plan_halt(
    robot: RobotModel, until: MotionPlan, roles: Mapping[str, Role], *, name: str = "halt",
    options: MotionOptions | None = None,
) -> MotionPlan:  # fmt: skip
    """From the end of `until` to rest: every joint stops where it is, and feet in the air are put down.

    Limbs that `roles` calls failed are locked.  Those whose feet are on the ground bear load until the others
    stand, because what they hold cannot be let go at once; so the body stays where it is.
    Limp ones bear nothing: where the others cannot balance without them, feet in the air are put down as fast as
    they can be, where the body can stay if they get there, and the plan says in `unbalanced_s` and `relaxed` for how
    long nothing is promised.
    Raises `UnsolvedError` when the optimiser finds no plan.
    """
    options = options or MotionOptions()
    failed = _failed(roles, "locked")
    now = hung(robot, end_state(robot, until, stopped=True), roles)
    down = [n for n, on in zip(robot.limb_names, now.ground, strict=True) if on]
    landing = [n for n in robot.limb_names if n not in down and n not in roles]
    held, lifted = (tuple(n for n in failed if (n in down) == on) for on in (True, False))
    free = [n for n in roles if n not in held]
    pattern = stand_pattern(robot, COLUMNS, swing_first=landing, free=free, step_columns=LANDING)
    # no higher than now: the body may have to stay where the locked feet on the ground keep it
    height = min(lowest(robot, until, lifted), CLEAR_M) if lifted else CLEAR_M
    families = (Locked(limbs=held), OffGround(foot_points(robot, lifted, now.joints), max(height - 1e-3, 0.0)))
    try:
        return _stand(robot, name, pattern, now, roles, options, families)
    except UnsolvedError:
        if not landing or not _failed(roles, "limp"):
            raise
    quick = replace(options, stand_seconds=CATCH * options.stand_seconds)
    late = quick.changed(Balance, lambda family: LateBalance(since=LANDING * quick.samples_per_column))
    try:
        caught = _stand(robot, name, pattern, now, roles, late, families)
    except UnsolvedError:
        never = tuple(f for f in quick.constraints if not isinstance(f, Balance))
        caught = _stand(robot, name, pattern, now, roles, replace(quick, constraints=never), families)
    seconds = quick.stand_seconds * LANDING / COLUMNS
    told = f"no balance for {seconds:.2f} s, until feet are put down"
    return replace(caught, unbalanced_s=seconds, relaxed=(*caught.relaxed, told))


def _failed(roles: Mapping[str, Role], mode: str) -> tuple[str, ...]:
    return tuple(n for n, role in roles.items() if isinstance(role, Failed) and role.mode == mode)


def hung(robot: RobotModel, state: Boundary, roles: Mapping[str, Role]) -> Boundary:
    """The state with limp limbs where they hang, and bearing nothing."""
    joints, ground = state.joints.copy(), state.ground.copy()
    for i, limb in enumerate(robot.limbs):
        role = roles.get(limb.name)
        if isinstance(role, Failed) and role.mode == "limp" and role.posture is not None:
            joints[robot.joint_indices(limb)], ground[i] = role.posture, False
    return replace(state, joints=joints, ground=ground)


def plan_clear(
    robot: RobotModel, halt: MotionPlan, roles: Mapping[str, Role], *, name: str = "clear",
    options: MotionOptions | None = None,
) -> MotionPlan:  # fmt: skip
    """From rest to rest on the limbs that are left: the failed ones are `CLEAR_M` off the ground at the end.

    Raises `UnsolvedError` when the optimiser finds no plan.
    """
    options = options or MotionOptions()
    failed = _failed(roles, "locked")
    now = end_state(robot, halt, stopped=True)
    pattern = stand_pattern(robot, COLUMNS, free=[n for n in robot.limb_names if n in roles])
    families = (OffGround(foot_points(robot, failed, now.joints), CLEAR_M + SPARE_M),)
    return _stand(robot, name, pattern, now, roles, options, families)


def _stand(
    robot: RobotModel, name: str, pattern: FootfallPattern, now: Boundary, roles: Mapping[str, Role],
    options: MotionOptions, families: tuple[Locked | OffGround, ...],
) -> MotionPlan:  # fmt: skip
    rest = rest_state(robot, now.joints, now.base)
    grid = Discretisation(pattern, options.samples_per_column, options.stand_seconds, Command(), now, rest)
    walking = tuple(i for i, row in enumerate(pattern.contact) if row.any())
    segment = Segment(name, "stand", robot, grid, walking, now.joints, partial(_guess, robot, now), dict(roles))
    low = 0.3 * (robot.nominal.step_height if options.step_height is None else options.step_height)
    return solve_segment(
        segment,
        replace(options, step_height=low, stability_shares=SHARES, constraints=(*options.constraints, *families)),
    )


def _guess(robot: RobotModel, now: Boundary, grid: Discretisation) -> Guess:
    """Nothing moves but feet that are put down."""
    poses, joints = np.tile(now.base, (grid.samples, 1)), np.tile(now.joints, (grid.samples, 1))
    feet = np.tile(robot.foot_positions(now.base, now.joints), (grid.samples, 1, 1))
    for i, limb in enumerate(robot.limbs):
        feet[grid.ground[:, i], i, 2] = limb.foot.radius
    return Guess(poses, joints, feet)
