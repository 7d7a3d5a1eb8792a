"""Families that write one instant: the loop over samples and limbs is here.

A subclass names the blocks of variables that it reads and writes what holds at one sample (of one limb,
when it reads a limb's joints or foot); numbers that differ between samples come in as parameters.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitforge.motion.family import Family
from gaitforge.motion.problem import Kernel, Problem, kernel
from gaitforge.motion.trajectory import Alike, Trajectory

Array = NDArray[np.float64]
Index = NDArray[np.intp]
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


@dataclass(frozen=True, eq=False)
class _Places:
    """Where a family speaks, limb by limb and sample by sample."""

    limbs: Sequence[int | None]
    variables: Index
    """(limbs · K, v)"""
    parameters: Array
    """(limbs · K, p)"""
    sizes: tuple[int, ...]
    """How many variables each block has"""


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

    def _places(self, trajectory: Trajectory) -> Iterator[_Places]:
        """Once for the body, or for all limbs with equally many joints."""
        if not {"joints", "foot"} & set(self.reads):
            yield self._of(trajectory, None, (None,))
            return
        for group in trajectory.alike:
            yield self._of(trajectory, group, group.limbs)

    def _of(self, trajectory: Trajectory, group: Alike | None, limbs: Sequence[int | None]) -> _Places:
        samples = trajectory.grid.samples
        blocks = [_block(trajectory, name, group) for name in self.reads]
        shape = (len(limbs), samples)
        variables = np.concatenate([np.broadcast_to(b, (*shape, b.shape[-1])) for b in blocks], axis=2)
        given = [np.asarray(self.parameters(trajectory, limb), dtype=float) for limb in limbs]
        values = np.stack([np.broadcast_to(v, (samples, v.shape[-1])) for v in given])
        rows = len(limbs) * samples
        sizes = tuple(int(block.shape[-1]) for block in blocks)
        return _Places(limbs, variables.reshape(rows, -1), values.reshape(rows, values.shape[2]), sizes)

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
        limbs, samples = trajectory.robot.limbs, range(trajectory.grid.samples)
        for at in self._places(trajectory):
            compiled = self._kernel(at.sizes, at.parameters.shape[1])
            labels = [k if limb is None else (limbs[limb].name, k) for limb in at.limbs for k in samples]
            shape = (len(labels), compiled.sizes[2])
            rows = problem.add_rows(self.name, *self.bounds(), shape, self.unit, labels)
            problem.add_term(self.name, compiled, at.variables, at.parameters, rows)

    def _kernel(self, sizes: tuple[int, ...], parameters: int) -> Kernel:
        return kernel((self, sizes), sum(sizes), parameters, lambda v, p: self.instant(self._split(v, sizes), p))


class SampleCost(SampleFamily):
    """∫ instant dt, a sum over the samples."""

    def add_to(self, problem: Problem, trajectory: Trajectory) -> None:
        """The cost of one instant, times dt, for every sample (and limb)."""
        for at in self._places(trajectory):
            seconds = np.full((len(at.parameters), 1), trajectory.grid.dt)
            compiled = self._kernel(at.sizes, at.parameters.shape[1])
            problem.add_term(self.name, compiled, at.variables, np.hstack([at.parameters, seconds]))

    def _kernel(self, sizes: tuple[int, ...], parameters: int) -> Kernel:
        def build(v: Any, p: Any) -> Any:
            return p[parameters] * self.instant(self._split(v, sizes), p[:parameters])

        return kernel((self, sizes), sum(sizes), parameters + 1, build)


def _block(trajectory: Trajectory, name: Block, group: Alike | None) -> Index:
    """(K, n) indices of a block's variables, (L, K, n) of limbs."""
    if name == "base":
        return trajectory.base
    if name == "com":
        return trajectory.com
    assert group is not None
    return group.joints if name == "joints" else group.feet
