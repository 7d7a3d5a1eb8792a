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
from gaitforge.robot.model import RobotModel

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]
Index = NDArray[np.intp]
WeightSet = tuple[int, tuple[int, ...], Index]
"""Sample, limbs in stance, (n,) variables of their CoP weights"""


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
    def _stance_feet(self) -> tuple[tuple[int, ...], ...]:
        """(m,) of every column"""
        return tuple(tuple(np.flatnonzero(column).tolist()) for column in self.pattern.contact.T)

    def stance_feet(self, interval: int) -> tuple[int, ...]:
        """The feet in stance over an interval; in a gait any whole number names one."""
        return self._stance_feet[interval // self.samples_per_column % len(self._stance_feet)]

    @cached_property
    def swings(self) -> tuple[Index, Index, Index]:
        """Swings that begin and end on the ground: limb, last ground sample before, first one after it (≥ K: wrapped).

        Limb by limb, in the order of time; each (swings,).
        """
        limb, stands = np.nonzero(self.ground.T)
        following = np.roll(stands, -1)
        last = np.append(limb[1:] != limb[:-1], True)[: len(limb)]
        first = np.roll(last, 1)
        following[last] = stands[first] + self.samples
        away = (following - stands > 1) & (self.cyclic | ~last)
        return limb[away], stands[away], following[away]

    @cached_property
    def airborne(self) -> tuple[Index, Index, Index, Index]:
        """Samples of these swings: limb, sample (≥ K: wrapped), and the ground samples before and after it."""
        limb, lift, land = self.swings
        inside = land - lift - 1
        count = np.arange(inside.sum()) - np.repeat(np.cumsum(inside) - inside, inside)
        limb, lift, land = (np.repeat(each, inside) for each in (limb, lift, land))
        return limb, lift + 1 + count, lift, land

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
class Alike:
    """Moving limbs with equally many joints, of which the same functions speak."""

    limbs: tuple[int, ...]
    """L of them"""
    rows: Index
    """(L, n) their joints among all joints"""
    joints: Index
    """(L, K, n) variables"""
    feet: Index
    """(L, K, 3) variables: centres of the foot spheres"""
    parameters: Array
    """(L, p) kinematic parameters"""


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
    alike: tuple[Alike, ...]
    """The moving limbs, those with equally many joints together"""
    joints: dict[int, Index]
    """limb → (K, n)"""
    feet: dict[int, Index]
    """limb → (K, 3) centre of the foot sphere"""
    weights: tuple[WeightSet, ...]
    """One or two per sample"""
    parameters: dict[int, Array] = field(default_factory=dict)
    """limb → kinematic parameters"""
    base_mass: float = 0.0
    base_moment: Array = field(default_factory=lambda: np.zeros(3))
    """(3,) first moment of the base with all limbs that do not move [kg m]"""
    stance: Stance = field(kw_only=True)
    """body (K, 3), joints (K, n_J): the commanded mean stance"""
    step_height: float = field(kw_only=True)
    """[m]"""

    @cached_property
    def foot_places(self) -> Index:
        """(n_F, K, 3) variables of the centres of all foot spheres; −1 for limbs that do not move."""
        places = np.full((len(self.robot.limbs), self.grid.samples, 3), -1, dtype=np.intp)
        for group in self.alike:
            places[list(group.limbs)] = group.feet
        return places


@dataclass(frozen=True, eq=False)
class Guess:
    """Where the optimiser starts, and how far variables may go."""

    base: Array
    """(K, 6)"""
    joints: Array
    """(K, n_J)"""
    feet: Array
    """(K, n_F, 3)"""
