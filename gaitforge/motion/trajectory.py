"""Samples of a segment and the variables that live at them.

A gait is written in a frame that moves along with the command, so that its last sample is its first
one and turning needs no special case; a transition or a stand is written in the world.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion.plan import Command, Stance
from gaitforge.motion.problem import Problem
from gaitforge.robot.kinematics import base_body, evaluate_limb, limb_parameters
from gaitforge.robot.model import RobotModel

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]
Index = NDArray[np.intp]
TAKE_OFF = 0.1
"""How much higher than asked for a foot may be one interval from the ground, as a part of the step height"""


@dataclass(frozen=True, eq=False)
class Boundary:
    """The state at one end of a transition or stand; `rest`: no velocity and a pose left to the optimiser."""

    joints: Array
    """(n_J,) [rad]; at rest: only the limbs that do not walk are bound to it"""
    joint_velocity: Array
    """(n_J,) [rad/s]"""
    base: Array
    """(6,) in the segment's frame; at rest a guess"""
    base_velocity: Array
    """(6,)"""
    com_velocity: Array
    """(3,) [m/s]"""
    ground: Bools
    """(n_F,) feet that are on the ground here, seen from across the seam"""
    rest: bool = False
    stance: Stance | None = None
    """The mean stance of the gait on this side; None: the nominal one."""


@dataclass(frozen=True, eq=False)
class Discretisation:
    """Times, contacts and neighbours of the samples of one segment."""

    pattern: FootfallPattern
    samples_per_column: int
    duration: float
    """[s]"""
    command: Command
    start: Boundary | None = None
    end: Boundary | None = None
    stance: Stance | None = None
    """The mean stance of a gait; None: the nominal one."""

    def stances(self, robot: RobotModel) -> Stance:
        """Body (K, 3) and joints (K, n_J) of the commanded stance; between two gaits evenly from one to the other."""
        own = Stance(np.array([robot.nominal.body_height, 0.0, 0.0]), np.asarray(robot.nominal.posture))
        if self.cyclic or self.start is None or self.end is None:
            first = last = self.stance or own
        else:
            first, last = self.start.stance or own, self.end.stance or own
        share = np.linspace(0.0, 1.0, self.samples)[:, None]
        return Stance(
            first.body + share * (last.body - first.body), first.joints + share * (last.joints - first.joints)
        )

    @cached_property
    def cyclic(self) -> bool:
        """A gait: the last sample is the first."""
        return self.pattern.cyclic

    @cached_property
    def intervals(self) -> int:
        """N"""
        return self.pattern.columns * self.samples_per_column

    @cached_property
    def samples(self) -> int:
        """K: unknown samples, N in a gait and N + 1 elsewhere."""
        return self.intervals if self.cyclic else self.intervals + 1

    @cached_property
    def dt(self) -> float:
        """[s]"""
        return self.duration / self.intervals

    @cached_property
    def contact(self) -> Bools:
        """(N, n_F) contact held over each interval."""
        return np.repeat(self.pattern.contact.T, self.samples_per_column, axis=0)

    @cached_property
    def ground(self) -> Bools:
        """(K, n_F) on the ground at each sample: in stance in the interval before or after it."""
        held = self.contact
        if self.cyclic:
            return np.asarray(held | np.roll(held, 1, axis=0))
        ground = np.zeros((self.samples, held.shape[1]), dtype=bool)
        ground[:-1] |= held
        ground[1:] |= held
        for at, end in ((0, self.start), (-1, self.end)):
            if end is not None:
                ground[at] |= end.ground
        return ground

    @cached_property
    def step(self) -> Array:
        """(3,) x, y [m], yaw [rad]: motion of the commanded frame over one interval (zero outside gaits)."""
        if not self.cyclic:
            return np.zeros(3)
        return planar_motion(self.command, self.dt)

    def neighbours(self, k: Index) -> tuple[Index, Index]:
        """Samples before and after; at an open end the sample itself."""
        if self.cyclic:
            return (k - 1) % self.samples, (k + 1) % self.samples
        return np.maximum(k - 1, 0), np.minimum(k + 1, self.samples - 1)

    def acceleration(self, k: int) -> tuple[Array, float, float]:
        """Coefficients (3,) of the samples before, at and after k, and of the start and end velocity."""
        h = self.dt
        if not self.cyclic and k == 0:
            return np.array([0.0, -2.0, 2.0]) / h**2, -2.0 / h, 0.0
        if not self.cyclic and k == self.samples - 1:
            return np.array([2.0, -2.0, 0.0]) / h**2, 0.0, 2.0 / h
        return np.array([1.0, -2.0, 1.0]) / h**2, 0.0, 0.0

    def accelerations(self, start: Array, end: Array) -> tuple[Array, Array]:
        """(K, 3) coefficients of the samples before, at and after each, (K, n) what velocities at open ends add."""
        coefficients = np.tile(np.array([1.0, -2.0, 1.0]) / self.dt**2, (self.samples, 1))
        added = np.zeros((self.samples, len(start)))
        for k in () if self.cyclic else (0, self.samples - 1):
            coefficients[k] = self.acceleration(k)[0]
            added[k] = self.end_velocity_terms(k, start, end)
        return coefficients, added

    def end_velocity_terms(self, k: int, start: Array, end: Array) -> Array:
        """What the velocities at open ends contribute to the acceleration at sample k."""
        _, from_start, from_end = self.acceleration(k)
        return from_start * start + from_end * end

    @cached_property
    def from_ground(self) -> NDArray[np.float64]:
        """(K, n_F) number of samples to the nearest ground sample (inf when there is none)."""
        order = np.arange(self.samples)
        gap = np.abs(order[:, None] - order)
        if self.cyclic:
            gap = np.minimum(gap, self.samples - gap)
        away = np.where(self.ground.T[:, None, :], gap, np.inf)  # (n_F, K, ground sample)
        return np.asarray(away.min(axis=2).T)


def smooth_step(share: Array | float) -> Array:
    """σ(s) = s³ (10 − 15 s + 6 s²): from 0 to 1 with no velocity and no acceleration at either end."""
    return np.asarray(share**3 * (10 - 15 * share + 6 * share**2))


def planar_motion(command: Command, seconds: ArrayLike) -> Array:
    """(…, 3) x, y, yaw after driving a constant body twist for some time (…)."""
    time = np.asarray(seconds, dtype=float)
    angle, way = command.yaw_rate * time, command.speed * time
    s = np.sinc(angle / np.pi)  # sin α / α
    c = np.sin(0.5 * angle) * np.sinc(0.5 * angle / np.pi)  # (1 − cos α) / α
    ahead, aside = np.cos(command.heading) * way, np.sin(command.heading) * way
    return np.stack([s * ahead - c * aside, c * ahead + s * aside, angle], axis=-1)


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Where the variables of each sample stand in the problem's vector."""

    robot: RobotModel
    grid: Discretisation
    moving: tuple[int, ...]
    """Limbs whose joints are variables; the others keep `fixed_joints`."""
    fixed_joints: Array
    """(n_J,)"""
    base: Index
    """(K, 6)"""
    com: Index
    """(K, 3)"""
    joints: dict[int, Index]
    """limb → (K, n)"""
    feet: dict[int, Index]
    """limb → (K, 3) centre of the foot sphere"""
    weights: tuple[tuple[int, tuple[int, ...], Index], ...]
    """(sample, limbs in stance, (n,) CoP weights), one or two per sample"""
    parameters: dict[int, Array] = field(default_factory=dict)
    """limb → kinematic parameters"""
    base_mass: float = 0.0
    base_moment: Array = field(default_factory=lambda: np.zeros(3))
    """(3,) first moment of the base with all limbs that do not move [kg m]"""
    stance: Stance = field(kw_only=True)
    """body (K, 3), joints (K, n_J): the commanded mean stance"""
    step_height: float = field(kw_only=True)
    """[m]"""


@dataclass(frozen=True, eq=False)
class Guess:
    """Where the optimiser starts, and how far variables may go."""

    base: Array
    """(K, 6)"""
    joints: Array
    """(K, n_J)"""
    feet: Array
    """(K, n_F, 3)"""


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
    count = grid.samples
    parameters = {i: limb_parameters(robot, limb) for i, limb in enumerate(robot.limbs)}
    mass, moment = _lumped(robot, moving, fixed_joints, parameters)
    stance = grid.stances(robot)
    base = problem.add_variables(guess.base, *_base_bounds(grid, guess, stance, tilt, height_range))
    com_guess = np.array([robot.center_of_mass(b, q) for b, q in zip(guess.base[:1], guess.joints[:1], strict=True)])
    com = problem.add_variables(com_guess + guess.base[:, :3] - guess.base[:1, :3], -np.inf, np.inf)
    joints, feet = {}, {}
    for i in moving:
        rows = robot.joint_indices(robot.limbs[i])
        start = guess.joints[:, rows]
        low = np.tile(np.minimum(robot.lower[rows] + joint_margin, start.min(axis=0)), (count, 1))
        high = np.tile(np.maximum(robot.upper[rows] - joint_margin, start.max(axis=0)), (count, 1))
        for at, end in ((0, grid.start), (-1, grid.end)):
            if end is not None and not end.rest:
                low[at] = high[at] = start[at] = end.joints[rows]
        joints[i] = problem.add_variables(start, low, high)
        bounds = _foot_bounds(robot, grid, i, step_height)
        feet[i] = problem.add_variables(guess.feet[:, i], *bounds)
    weights = _add_weights(problem, grid, minimum_weight)
    return Trajectory(
        robot, grid, moving, fixed_joints, base, com, joints, feet, weights, parameters, mass, moment,
        stance=stance, step_height=step_height,
    )  # fmt: skip


def _lumped(
    robot: RobotModel, moving: tuple[int, ...], fixed: Array, parameters: dict[int, Array]
) -> tuple[float, Array]:
    mass, moment = base_body(robot)
    for i, limb in enumerate(robot.limbs):
        if i not in moving:
            moment = moment + evaluate_limb(fixed[None, robot.joint_indices(limb)], parameters[i]).moment[0]
    return mass, moment


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


def _foot_bounds(robot: RobotModel, grid: Discretisation, limb: int, step_height: float) -> tuple[Array, Array]:
    """Sphere centre at its radius on the ground, at least the step height away from it; ends are free.

    Where there is time a foot leaves and meets the ground slowly: a spline that has to climb half a step in its
    first interval dips in the one before, where the foot stands.
    """
    radius = robot.limbs[limb].foot.radius
    low, high = np.full((grid.samples, 3), -np.inf), np.full((grid.samples, 3), np.inf)
    away = grid.from_ground[:, limb]
    ground = grid.ground[:, limb]
    ramp = _ramp(grid, ground)
    low[:, 2] = radius + step_height * smooth_step(np.minimum(1.0, away / ramp))
    gentle = (away == 1) & (ramp > grid.samples_per_column)
    high[gentle, 2] = low[gentle, 2] + TAKE_OFF * step_height
    high[ground, 2] = low[ground, 2] = radius
    for at, end in ((0, grid.start), (-1, grid.end)):
        if end is not None and not end.rest:
            low[at], high[at] = -np.inf, np.inf
    return low, high


def _ramp(grid: Discretisation, ground: NDArray[np.bool_]) -> Array:
    """(K,) intervals in which a foot reaches its step height: two columns where the swing is long enough for that."""
    ramp = np.full(grid.samples, float(grid.samples_per_column))
    for lift, land in swings(ground, grid.cyclic):
        gentle = min(2.0 * grid.samples_per_column, 0.5 * (land - lift))
        ramp[np.arange(lift, land + 1) % grid.samples] = max(grid.samples_per_column, gentle)
    stands = np.flatnonzero(ground)
    if not grid.cyclic and len(stands):  # lifted for good, or landing from the gait before
        most = 2.0 * grid.samples_per_column
        ramp[: stands[0]] = max(grid.samples_per_column, min(most, stands[0]))
        ramp[stands[-1] + 1 :] = max(grid.samples_per_column, min(most, grid.samples - 1 - stands[-1]))
    return ramp


def swings(ground: NDArray[np.bool_], cyclic: bool) -> list[tuple[int, int]]:
    """(last ground sample, first ground sample after it) of every swing that has both; the latter may exceed K."""
    stands = np.flatnonzero(ground)
    if not len(stands):
        return []
    following = np.append(stands[1:], stands[0] + len(ground)) if cyclic else stands[1:]
    return [(int(a), int(b)) for a, b in zip(stands, following, strict=False) if b - a > 1]


def _add_weights(
    problem: Problem, grid: Discretisation, minimum_weight: float
) -> tuple[tuple[int, tuple[int, ...], Index], ...]:
    """CoP weights for the feet of the interval before and of the one after each sample."""
    held, out = grid.contact, []
    for k in range(grid.samples):
        around = [k - 1, k] if grid.cyclic else [j for j in (k - 1, k) if 0 <= j < grid.intervals]
        sets = {tuple(np.flatnonzero(held[j % grid.intervals]).tolist()) for j in around}
        for feet in sorted(sets):
            share = 1.0 / len(feet)
            index = problem.add_variables(np.full(len(feet), share), minimum_weight * share, np.inf)
            out.append((k, feet, index))
    return tuple(out)
