"""Transitions from one gait into another: optimised, or interpolated by equation (3)."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion.interpolate import interpolate
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import Command, MotionPlan
from gaitforge.motion.segment import Segment
from gaitforge.motion.solve import solve_segment
from gaitforge.motion.state import end_state, gait_state
from gaitforge.motion.trajectory import Boundary, Discretisation, Guess, planar_motion
from gaitforge.robot.model import RobotModel
from gaitforge.task.roles import Role

Array = NDArray[np.float64]
Method = Literal["optimise", "interpolate"]


def plan_transition(
    robot: RobotModel,
    before: MotionPlan,
    after: MotionPlan,
    *,
    pattern: FootfallPattern | None = None,
    column_s: float | None = None,
    method: Method = "optimise",
    roles: Mapping[str, Role] | None = None,
    name: str = "transition",
    options: MotionOptions | None = None,
) -> MotionPlan:
    """A motion plan that leaves gait `before` at the end of a cycle and enters gait `after` at its start.

    `before` may be a stand too, which is left from where it ends.

    Joint positions and velocities are continuous at both ends by construction (the spline is clamped
    to the gaits' end velocities); the body covers at least the `progress` family's share of the mean
    commanded travel.  `pattern`: the transition's C (synthesised when None), `column_s` [s] its time
    per column.  `method="interpolate"` is equation (3) of the paper, without any optimisation.  The robot
    carries what it carries in gait `before`.
    Raises `UnsolvedError` when the optimiser finds no plan.
    """
    robot = robot.carrying(*before.loads)
    if method == "interpolate":
        return interpolate(robot, before, after, name)
    options = options or MotionOptions()
    if pattern is None:
        from gaitforge.footfall.synthesis import synthesize_transition_pattern

        pattern = synthesize_transition_pattern(
            robot, before.pattern, after.pattern, columns=robot.nominal.transition_columns
        )
    seconds = pattern.columns * (robot.nominal.transition_column_s if column_s is None else column_s)
    command = mean_command(before.command, after.command)
    travel = planar_motion(command, seconds)
    start = gait_state(robot, before) if before.kind == "gait" else end_state(robot, before)
    end = gait_state(robot, after, yaw=float(travel[2]))
    grid = Discretisation(pattern, options.samples_per_column, seconds, command, start, end)
    moving = _moving(robot, pattern, start, end)
    guess = partial(_guess, robot, start, end, travel)
    named = dict(after.roles) if roles is None else {robot.limb(n).name: r for n, r in roles.items()}
    return solve_segment(Segment(name, "transition", robot, grid, moving, start.joints, guess, named), options)


def mean_command(a: Command, b: Command) -> Command:
    """The command half-way between two: mean velocity vector, mean yaw rate; the higher steps of both."""
    va, vb = (c.speed * np.array([np.cos(c.heading), np.sin(c.heading)]) for c in (a, b))
    mean = 0.5 * (va + vb)
    heading = float(np.arctan2(mean[1], mean[0])) if np.linalg.norm(mean) > 0 else a.heading
    steps = [c.step_height for c in (a, b) if c.step_height is not None]
    rate = 0.5 * (a.yaw_rate + b.yaw_rate)
    return Command(float(np.linalg.norm(mean)), heading, rate, step_height=max(steps, default=None))


def _moving(robot: RobotModel, pattern: FootfallPattern, start: Boundary, end: Boundary) -> tuple[int, ...]:
    """Limbs that are ever in stance, and limbs whose posture changes."""
    moving = []
    for i, limb in enumerate(robot.limbs):
        rows = robot.joint_indices(limb)
        if pattern.contact[i].any() or np.abs(start.joints[rows] - end.joints[rows]).max() > 1e-9:
            moving.append(i)
    return tuple(moving)


def _guess(robot: RobotModel, start: Boundary, end: Boundary, travel: Array, grid: Discretisation) -> Guess:
    """Base and joints on straight lines; feet where they stand before and after their own step."""
    share = np.linspace(0.0, 1.0, grid.samples)[:, None]
    last = end.base.copy()
    last[:2] = start.base[:2] + travel[:2]
    base = start.base + share * (last - start.base)
    joints = start.joints + share * (end.joints - start.joints)
    first, final = robot.foot_positions(start.base, start.joints), robot.foot_positions(last, end.joints)
    feet = np.empty((grid.samples, *first.shape))
    for i in range(len(first)):
        progress = _step_progress(grid.ground[:, i])[:, None]
        feet[:, i] = first[i] + progress * (final[i] - first[i])
        feet[grid.ground[:, i], i, 2] = robot.limbs[i].foot.radius
    return Guess(base, joints, feet)


def _step_progress(ground: NDArray[np.bool_]) -> Array:
    """(K,) 0 before a limb's step, 1 after it, a straight line while it is in the air."""
    air = ~ground
    if not air.any() or air.all():
        return np.linspace(0.0, 1.0, len(ground))
    done = np.cumsum(air) / air.sum()
    return np.asarray(done, dtype=float)
