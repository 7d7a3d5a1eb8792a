"""Families that write one instant: the loop over samples and limbs is here.

A subclass names the blocks of variables that it reads and writes what holds at one sample (of one limb,
when it reads a limb's joints or foot); numbers that differ between samples come in as parameters.
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitforge.motion.family import Family
from gaitforge.motion.problem import Kernel, Problem, kernel
from gaitforge.motion.trajectory import Trajectory

Array = NDArray[np.float64]
Block = Literal["base", "com", "joints", "foot"]


@dataclass(frozen=True)
class Instant:
    """CasADi column vectors of one sample; those that a family does not read are None."""

    base: Any = None
    """(6,) x, y, z [m], roll, pitch, yaw [rad]"""
    com: Any = None
    """(3,) [m]"""
    joints: Any = None
    """(n,) of one limb [rad]"""
    foot: Any = None
    """(3,) centre of the foot sphere [m]"""


class SampleFamily(Family):
    """Base of families that say the same at every sample."""

    reads: ClassVar[tuple[Block, ...]] = ("base",)
    """Blocks that `instant` is given, in this order; with joints or foot the family speaks of every moving limb."""

    @abstractmethod
    def instant(self, at: Instant, p: Any) -> Any:
        """What is said at one sample: rows of a constraint, or the density of a cost [per second]."""

    def parameters(self, trajectory: Trajectory, limb: int | None) -> ArrayLike:
        """(p,) or, where they differ between samples, (K, p) numbers for `instant`; none by default."""
        return np.zeros(0)

    def limbs(self, trajectory: Trajectory) -> tuple[int | None, ...]:
        """The limbs spoken of; (None,) for a family of the body."""
        return trajectory.moving if {"joints", "foot"} & set(self.reads) else (None,)

    def _places(self, trajectory: Trajectory, limb: int | None) -> tuple[Array, Array, tuple[int, ...]]:
        """Variables (K, v), parameters (K, p) and the sizes of the blocks."""
        blocks = [_block(trajectory, name, limb) for name in self.reads]
        values = np.asarray(self.parameters(trajectory, limb), dtype=float)
        if values.ndim < 2:
            values = np.tile(values, (trajectory.grid.samples, 1))
        return np.hstack(blocks), values, tuple(block.shape[1] for block in blocks)

    def _split(self, v: Any, sizes: tuple[int, ...]) -> Instant:
        ends = np.cumsum((0, *sizes)).tolist()
        return Instant(**{n: v[a:b] for n, a, b in zip(self.reads, ends[:-1], ends[1:], strict=True)})


class SampleConstraint(SampleFamily):
    """lower ≤ instant ≤ upper at every sample."""

    @abstractmethod
    def bounds(self) -> tuple[ArrayLike, ArrayLike]:
        """Lower and upper bounds of the rows of one instant."""

    def add_to(self, problem: Problem, trajectory: Trajectory) -> None:
        """The rows of one instant for every sample (and limb)."""
        for limb in self.limbs(trajectory):
            variables, parameters, sizes = self._places(trajectory, limb)
            compiled = self._kernel(sizes, parameters.shape[1])
            samples = range(trajectory.grid.samples)
            labels = [k if limb is None else (trajectory.robot.limbs[limb].name, k) for k in samples]
            shape = (len(labels), compiled.sizes[2])
            rows = problem.add_rows(self.name, *self.bounds(), shape, self.unit, labels)
            problem.add_term(self.name, compiled, variables, parameters, rows)

    def _kernel(self, sizes: tuple[int, ...], parameters: int) -> Kernel:
        return kernel((self, sizes), sum(sizes), parameters, lambda v, p: self.instant(self._split(v, sizes), p))


class SampleCost(SampleFamily):
    """∫ instant dt, a sum over the samples."""

    def add_to(self, problem: Problem, trajectory: Trajectory) -> None:
        """The cost of one instant, times dt, for every sample (and limb)."""
        for limb in self.limbs(trajectory):
            variables, parameters, sizes = self._places(trajectory, limb)
            seconds = np.full((len(parameters), 1), trajectory.grid.dt)
            compiled = self._kernel(sizes, parameters.shape[1])
            problem.add_term(self.name, compiled, variables, np.hstack([parameters, seconds]))

    def _kernel(self, sizes: tuple[int, ...], parameters: int) -> Kernel:
        def build(v: Any, p: Any) -> Any:
            return p[parameters] * self.instant(self._split(v, sizes), p[:parameters])

        return kernel((self, sizes), sum(sizes), parameters + 1, build)


def _block(trajectory: Trajectory, name: Block, limb: int | None) -> NDArray[np.intp]:
    """(K, n) indices of a block's variables."""
    if name == "base":
        return trajectory.base
    if name == "com":
        return trajectory.com
    assert limb is not None
    return trajectory.joints[limb] if name == "joints" else trajectory.feet[limb]
