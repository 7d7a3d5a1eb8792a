"""The variables of a segment: which there are, where they begin, and their bounds."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.plan import Stance
from gaitforge.motion.problem import Problem
from gaitforge.motion.trajectory import Alike, Discretisation, Guess, Trajectory, smooth_step
from gaitforge.robot.kinematics import base_body, evaluate_limb, limb_parameters
from gaitforge.robot.model import RobotModel

Array = NDArray[np.float64]
Index = NDArray[np.intp]
TAKE_OFF = 0.1
"""How much higher than asked for a foot may be one interval from the ground, as a part of the step height"""


def lay_out(
    problem: Problem,
    robot: RobotModel,
    grid: Discretisation,
    moving: tuple[int, ...],
    fixed_joints: Array,
    guess: Guess,
    step_height: float,
    minimum_weight: float,
    tilt: float,
    height_range: float,
    joint_margin: float,
) -> Trajectory:
    """Add the variables of a segment to the problem, with their bounds."""
    parameters = {i: limb_parameters(robot, limb) for i, limb in enumerate(robot.limbs)}
    mass, moment = _lumped(robot, moving, fixed_joints, parameters)
    stance = grid.stances(robot)
    base = problem.add_variables(guess.base, *_base_bounds(grid, guess, stance, tilt, height_range))
    com_guess = robot.center_of_mass(guess.base[0], guess.joints[0])
    com = problem.add_variables(com_guess + guess.base[:, :3] - guess.base[:1, :3], -np.inf, np.inf)
    alike, foot_bounds = [], _foot_bounds(robot, grid, step_height)
    for limbs in _with_equally_many_joints(robot, moving):
        members = list(limbs)
        rows = np.array([robot.joint_indices(robot.limbs[i]) for i in limbs])
        joints = problem.add_variables(*_joint_bounds(robot, grid, guess, rows, joint_margin))
        heights = (bound[:, members].transpose(1, 0, 2) for bound in foot_bounds)
        feet = problem.add_variables(guess.feet[:, members].transpose(1, 0, 2), *heights)
        alike.append(Alike(limbs, rows, joints, feet, np.array([parameters[i] for i in limbs])))
    weights = _add_weights(problem, grid, minimum_weight)
    return Trajectory(
        robot, grid, moving, fixed_joints, base, com, tuple(alike),
        {i: index for group in alike for i, index in zip(group.limbs, group.joints, strict=True)},
        {i: index for group in alike for i, index in zip(group.limbs, group.feet, strict=True)},
        weights, parameters, mass, moment, stance=stance, step_height=step_height,
    )  # fmt: skip


def _lumped(
    robot: RobotModel, moving: tuple[int, ...], fixed: Array, parameters: dict[int, Array]
) -> tuple[float, Array]:
    mass, moment = base_body(robot)
    for i, limb in enumerate(robot.limbs):
        if i not in moving:
            moment = moment + evaluate_limb(fixed[None, robot.joint_indices(limb)], parameters[i]).moment[0]
    return mass, moment


def _with_equally_many_joints(robot: RobotModel, moving: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
    counts = [len(robot.limbs[i].joints) for i in moving]
    for count in dict.fromkeys(counts):
        yield tuple(i for i, n in zip(moving, counts, strict=True) if n == count)


def _base_bounds(
    grid: Discretisation, guess: Guess, stance: Stance, tilt: float, height_range: float
) -> tuple[Array, Array]:
    low, high = np.full(guess.base.shape, -np.inf), np.full(guess.base.shape, np.inf)
    low[:, 2], high[:, 2] = guess.base[:, 2] - height_range, guess.base[:, 2] + height_range
    low[:, 3:5], high[:, 3:5] = stance.body[:, 1:] - tilt, stance.body[:, 1:] + tilt
    low[:, 5], high[:, 5] = guess.base[:, 5] - 0.5, guess.base[:, 5] + 0.5
    if grid.cyclic:
        low[0, :2] = high[0, :2] = guess.base[0, :2]  # the gauge: where the gait begins does not matter
    if grid.start is not None and not grid.start.rest:
        low[0] = high[0] = guess.base[0] = grid.start.base
    if grid.end is not None and not grid.end.rest:
        low[-1, 2:] = high[-1, 2:] = guess.base[-1, 2:] = grid.end.base[2:]
    return low, high


def _joint_bounds(
    robot: RobotModel, grid: Discretisation, guess: Guess, rows: Index, margin: float
) -> tuple[Array, Array, Array]:
    """(L, K, n) where the joints `rows` (L, n) begin, and their limits; a guess is never outside."""
    start = guess.joints[:, rows].transpose(1, 0, 2)
    low, high = np.empty_like(start), np.empty_like(start)
    low[:] = np.minimum(robot.lower[rows] + margin, start.min(axis=1))[:, None]
    high[:] = np.maximum(robot.upper[rows] - margin, start.max(axis=1))[:, None]
    for at, end in ((0, grid.start), (-1, grid.end)):
        if end is not None and not end.rest:
            low[:, at] = high[:, at] = start[:, at] = end.joints[rows]
    return start, low, high


def _foot_bounds(robot: RobotModel, grid: Discretisation, step_height: float) -> tuple[Array, Array]:
    """(K, n_F, 3) sphere centres at their radius on the ground, at least the step height away from it; ends are free.

    Where there is time a foot leaves and meets the ground slowly: a spline that has to climb half a step in its
    first interval dips in the one before, where the foot stands.
    """
    radii = np.array([limb.foot.radius for limb in robot.limbs])
    low, high = np.full((*grid.ground.shape, 3), -np.inf), np.full((*grid.ground.shape, 3), np.inf)
    away, ramp = grid.from_ground, _ramp(grid)
    floor = radii + step_height * smooth_step(np.minimum(1.0, away / ramp))
    gentle = (away == 1) & (ramp > grid.samples_per_column)
    roof = np.where(gentle, floor + TAKE_OFF * step_height, np.inf)
    low[..., 2], high[..., 2] = floor, np.where(grid.ground, floor, roof)
    for at, end in ((0, grid.start), (-1, grid.end)):
        if end is not None and not end.rest:
            low[at], high[at] = -np.inf, np.inf
    return low, high


def _ramp(grid: Discretisation) -> Array:
    """(K, n_F) intervals in which a foot reaches its step height: two columns where the swing is long enough for that.

    Lifted for good, or landing from the gait before, it has as long as the swing lasts.
    """
    least, most = float(grid.samples_per_column), 2.0 * grid.samples_per_column
    ramp = np.full(grid.ground.shape, least)
    limb, k, lift, land = grid.airborne
    ramp[k % grid.samples, limb] = np.clip(0.5 * (land - lift), least, most)
    if grid.cyclic:
        return ramp
    stands, samples = grid.ground.any(axis=0), np.arange(grid.samples)[:, None]
    first, last = grid.ground.argmax(axis=0), grid.samples - 1 - grid.ground[::-1].argmax(axis=0)
    ramp = np.where(stands & (samples < first), np.clip(first, least, most), ramp)
    return np.where(stands & (samples > last), np.clip(grid.samples - 1 - last, least, most), ramp)


def _add_weights(
    problem: Problem, grid: Discretisation, minimum_weight: float
) -> tuple[tuple[int, tuple[int, ...], Index], ...]:
    """CoP weights for the feet of the interval before and of the one after each sample."""
    sets = []
    for k in range(grid.samples):
        around = [j for j in (k - 1, k) if grid.cyclic or 0 <= j < grid.intervals]
        sets += [(k, feet) for feet in sorted({grid.stance_feet(j) for j in around})]
    counts = [len(feet) for _, feet in sets]
    share = np.repeat(1.0 / np.maximum(1, counts), counts)
    index = problem.add_variables(share, minimum_weight * share, np.inf)
    ends = accumulate(counts)
    return tuple((k, feet, index[end - len(feet) : end]) for (k, feet), end in zip(sets, ends, strict=True))
