"""Stands: from rest into a gait, and from a gait to rest, on all feet that walk."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from gaitforge.footfall.given import stand_pattern
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion.constraints.progress import Progress
from gaitforge.motion.costs.smoothness import Smoothness
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import Command, MotionPlan
from gaitforge.motion.segment import Segment, step_height
from gaitforge.motion.solve import solve_segment
from gaitforge.motion.state import gait_state, rest_state
from gaitforge.motion.trajectory import Boundary, Discretisation, Guess
from gaitforge.robot.model import RobotModel

Array = NDArray[np.float64]
COLUMNS = 4
STEADY = 50.0
"""How much more the acceleration of the base costs in a stand than in a gait."""
LOW = 0.3
"""Height of a stand's steps, as a share of the gait's."""
PROGRESS = 0.7
"""Share of the way of a steady acceleration that a stand covers at least."""


def plan_start(
    robot: RobotModel, gait: MotionPlan, *, name: str = "start", options: MotionOptions | None = None
) -> MotionPlan:
    """From rest into the first sample of a gait; feet that the gait begins in the air are lifted at the end."""
    return _plan(robot, gait, name, options or MotionOptions(), starting=True)


def plan_stop(
    robot: RobotModel, gait: MotionPlan, *, name: str = "stop", options: MotionOptions | None = None
) -> MotionPlan:
    """From the end of a gait's cycle to rest; feet that are then in the air are put down first."""
    return _plan(robot, gait, name, options or MotionOptions(), starting=False)


def _plan(robot: RobotModel, gait: MotionPlan, name: str, options: MotionOptions, starting: bool) -> MotionPlan:
    robot, seconds = robot.carrying(*gait.loads), options.stand_seconds
    moving = gait_state(robot, gait)
    heading = np.array([np.cos(gait.command.heading), np.sin(gait.command.heading)])
    away = 0.5 * gait.command.speed * seconds * heading * (-1.0 if starting else 1.0)
    base = moving.base.copy()
    base[:2] += away
    rest = rest_state(robot, moving.joints, base, gait.stance)
    pattern = _pattern(robot, gait, starting)
    # mean speed of a steady acceleration: without it the body swings back before it goes ahead
    # feet lifted into a gait's first sample need not go as high as a step
    low = LOW * step_height(robot, gait.command, options)
    command = Command(0.5 * gait.command.speed, gait.command.heading, 0.0, step_height=low)
    start, end = (rest, moving) if starting else (moving, rest)
    grid = Discretisation(pattern, options.samples_per_column, seconds, command, start, end)
    walking = tuple(i for i, row in enumerate(pattern.contact) if row.any())
    guess = partial(_guess, robot, moving)
    segment = Segment(name, "stand", robot, grid, walking, moving.joints, guess, dict(gait.roles))
    # a steady acceleration: with a gait's light weight on it the body goes ahead, waits and goes again
    steady = options.changed(Smoothness, lambda cost: replace(cost, position=STEADY * cost.position))
    steady = steady.changed(Progress, lambda family: replace(family, share=PROGRESS))
    return solve_segment(segment, steady)


def _guess(robot: RobotModel, moving: Boundary, grid: Discretisation) -> Guess:
    """The gait's seam posture all along, the base on a parabola between rest and the gait's speed."""
    assert grid.start is not None
    assert grid.end is not None
    share = np.linspace(0.0, 1.0, grid.samples)[:, None]
    curve = share**2 if grid.start.rest else 2 * share - share**2
    poses = grid.start.base + curve * (grid.end.base - grid.start.base)
    feet = np.tile(robot.foot_positions(moving.base, moving.joints), (grid.samples, 1, 1))
    for i, limb in enumerate(robot.limbs):
        feet[grid.ground[:, i], i, 2] = limb.foot.radius
    return Guess(poses, np.tile(moving.joints, (grid.samples, 1)), feet)


def _pattern(robot: RobotModel, gait: MotionPlan, starting: bool) -> FootfallPattern:
    """All walking limbs in stance, but for those in the air at the gait's seam."""
    walks = gait.pattern.locomotive
    seam = gait.pattern.contact[:, 0] | gait.pattern.contact[:, -1]
    airborne = [n for n, down in zip(gait.pattern.limbs, seam, strict=True) if not down and n in walks]
    free = [n for n in gait.pattern.limbs if n not in walks]
    lifted, landing = (airborne, []) if starting else ([], airborne)
    return stand_pattern(robot, COLUMNS, swing_first=landing, swing_last=lifted, free=free)
