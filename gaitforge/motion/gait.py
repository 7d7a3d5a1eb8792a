"""Cyclic gaits from a footfall pattern and a command."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from gaitforge.errors import InputError, Problem
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion.aim import aim_joints
from gaitforge.motion.duration import load_of, shortest
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import Command, MotionPlan, Stance
from gaitforge.motion.segment import Segment
from gaitforge.motion.solve import solve_segment
from gaitforge.motion.stance import Posture, commanded_stance
from gaitforge.motion.strength import refuse_weak_modules
from gaitforge.motion.trajectory import Discretisation, Guess, planar_motion
from gaitforge.robot.model import RobotModel
from gaitforge.robot.payload import Load
from gaitforge.task.roles import Failed, Held, Role, Tool

Array = NDArray[np.float64]


def plan_gait(
    robot: RobotModel,
    pattern: FootfallPattern,
    *,
    speed: float | None = None,
    heading: float = 0.0,
    yaw_rate: float = 0.0,
    body_height: float | None = None,
    roll: float = 0.0,
    pitch: float = 0.0,
    step_height: float | None = None,
    posture: Posture | None = None,
    duration: float | Literal["auto"] | None = None,
    samples_per_column: int | None = None,
    roles: Mapping[str, Role] | None = None,
    postures: Mapping[str, Array] | None = None,
    expected_base: tuple[float, float, float] = (0.0, 0.0, 0.0),
    loads: Sequence[Load] | None = None,
    name: str = "gait",
    options: MotionOptions | None = None,
) -> MotionPlan:
    """A periodic motion plan P for the pattern.

    `speed` [m/s], `heading` [rad] of the velocity in the body frame, `yaw_rate` [rad/s]; `body_height`
    [m], `roll` and `pitch` [rad] in the mean, `step_height` [m], `posture`: how the limbs that walk stand,
    by a name of the robot's or limb name → joints [rad], by default the one that the pattern's footholds
    were placed with, if they were (g11); `duration` [s] of one cycle, or ``auto``:
    the shortest with joint speeds and torques below their `speed_share` and `effort_share`.  None takes
    the robot's nominal value.  `samples_per_column`: r, kept as it is
    when given; None begins with two and lets refinement take more.  `roles`: limb or tool name → what a limb
    that does not walk is for; `postures`: limb name → its joint positions (n,) [rad] (where a failed
    limb is locked, say), by default the held posture, and for a tool limb that looks at a point the
    one that does so from `expected_base`: x, y [m] and yaw [rad] of the base in the target's frame
    in the middle of this gait.  `loads`: what the robot carries, which
    counts in the centre of mass; None: what `robot` carries already.
    Raises `InputError` for unknown limbs, `InfeasibleMotion` with a geometric certificate, and
    `UnsolvedError` when the optimiser finds no plan, saying which family, limb and sample resist.
    """
    from gaitforge.motion.limits import refuse_grounded_trunk, refuse_impossible_speed, refuse_impossible_stance

    robot = robot if loads is None else robot.carrying(*loads)
    options = options or MotionOptions()
    if samples_per_column is not None:  # asked for by name: no other grid
        options = replace(options, samples_per_column=samples_per_column, finest=samples_per_column)
    nominal = robot.nominal
    speed = nominal.speed if speed is None else speed
    command = Command(speed, heading, yaw_rate, body_height, roll, pitch, step_height)
    placed = pattern.info.get("posture_rad")  # stands on the footholds that its margin speaks of
    stance = commanded_stance(robot, command, placed if posture is None else posture)
    walking = tuple(i for i, row in enumerate(pattern.contact) if row.any())
    named = {robot.limb(limb).name: role for limb, role in (roles or {}).items()}
    given = {**_mean_aims(robot, named, expected_base), **(postures or {})}
    fixed = resting_joints(robot, stance, walking, named, given)

    def plan_at(seconds: float) -> MotionPlan:
        grid = Discretisation(pattern, options.samples_per_column, seconds, command, stance=stance)
        refuse_impossible_speed(robot, grid)
        refuse_impossible_stance(robot, grid, options)
        refuse_grounded_trunk(robot, grid, options)
        refuse_weak_modules(robot, grid, options)
        guess = partial(nominal_guess, robot, stance, fixed)
        segment = Segment(name, "gait", robot, grid, walking, fixed, guess, named)
        return solve_segment(segment, options)

    if duration == "auto":
        return shortest(nominal.duration, plan_at, partial(load_of, options))
    return plan_at(nominal.duration if duration is None else duration)


def _mean_aims(
    robot: RobotModel, roles: Mapping[str, Role], expected_base: tuple[float, float, float]
) -> dict[str, Array]:
    """Limb name → joints (n,) that look at the target from the expected place of the nominal body."""
    aims = {}
    for name, role in roles.items():
        if not isinstance(role, Tool):
            continue
        tool = robot.tool(name)
        if tool is None:
            raise InputError(Problem(robot.name, f"roles.{name}", "a tool role", "a limb that carries a camera"))
        if isinstance(role.look_at, str):
            continue
        x, y, yaw = expected_base if role.frame == "world" else (0.0, 0.0, 0.0)
        base = np.array([[x, y, robot.nominal.body_height, 0.0, 0.0, yaw]])
        limb = robot.limb(name)
        home = robot.nominal.held_posture[robot.joint_indices(limb)]
        aims[name] = aim_joints(robot, limb, tool, base, np.array(role.look_at), home)[0]
    return aims


def resting_joints(
    robot: RobotModel,
    stance: Stance,
    walking: tuple[int, ...],
    roles: Mapping[str, Role],
    postures: Mapping[str, Array],
) -> Array:
    """(n_J,) the commanded stance for limbs that walk, what they keep for the others."""
    joints = np.array(stance.joints, dtype=float)
    for i, limb in enumerate(robot.limbs):
        if i in walking:
            continue
        rows = robot.joint_indices(limb)
        role = roles.get(limb.name)
        joints[rows] = robot.nominal.held_posture[rows]
        if isinstance(role, Held | Failed) and role.posture is not None:
            joints[rows] = role.posture
        if limb.name in postures:
            joints[rows] = postures[limb.name]
    return joints


def nominal_guess(robot: RobotModel, stance: Stance, joints: Array, grid: Discretisation) -> Guess:
    """Where the optimisation begins: the commanded stance, feet sweeping back through their places while they stand."""
    count = grid.samples
    base = np.zeros((count, 6))
    base[:, 2:5] = stance.body
    feet = np.tile(robot.foot_positions(base[0], stance.joints), (count, 1, 1))
    feet[..., :2] += planar_motion(grid.command, -_stance_progress(grid.contact) * grid.dt)[..., :2]
    return Guess(base, np.tile(joints, (count, 1)), feet)


def _stance_progress(held: NDArray[np.bool_]) -> Array:
    """(N, n_F) intervals since the middle of the stance phase; linear back to the front during swing."""
    count = len(held)
    steps = held.any(axis=0) & ~held.all(axis=0)
    here = np.tile(held[:, steps], (3, 1))  # a cycle before and one after
    before = np.roll(here, 1, axis=0)
    k = np.arange(len(here))[:, None]
    landed = np.maximum.accumulate(np.where(here & ~before, k, 0))
    lifts, lands = (
        np.minimum.accumulate(np.where(change, k, len(here))[::-1])[::-1] for change in (~here & before, here & ~before)
    )
    middle, limb = slice(count, 2 * count), np.arange(here.shape[1])
    since = (k - landed)[middle]
    lift = lifts[landed[middle], limb]
    length, swing = lift - landed[middle], lands[lift, limb] - lift
    back = 0.5 * length - length * (since - length) / swing
    progress = np.zeros(held.shape)
    progress[:, steps] = np.where(since <= length, since - 0.5 * length, back)
    return progress
