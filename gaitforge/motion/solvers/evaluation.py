"""Values and derivatives of a problem at a point, written into arrays that are allocated once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from gaitforge.motion.problem import Problem
from gaitforge.motion.solvers.generated import compiled_map
from gaitforge.motion.solvers.structure import Group, Structure

Array = NDArray[np.float64]


class Evaluation:
    """f, g, ∇f, J and the upper triangle of ∇²L + the rows of J as nonzeros of K, at the last point asked for.

    L = f + yᵀ g.  Arrays are overwritten by the next call.
    """

    def __init__(self, structure: Structure, native: bool = True) -> None:
        self.structure = structure
        values, jacobians, hessians = structure.sizes
        self._values = np.zeros(values)
        self._derivatives = np.zeros(hessians + jacobians)
        self._full = np.zeros(structure.size)
        self._calls: list[_Call] = []
        at = [0, hessians, 0]
        for group in structure.groups:
            n = len(group.variables)
            lengths = [n * len(group.kernel.hessian_rc[0]), n * len(group.kernel.jacobian_rc[0])]
            lengths.append(n * group.kernel.sizes[2])
            h, j, r = (slice(a, a + length) for a, length in zip(at, lengths, strict=True))
            out = (self._values[r], self._derivatives[j], self._derivatives[h])
            self._calls.append(_Call(group, *out, native))
            at = [a + length for a, length in zip(at, lengths, strict=True)]
        where, indices, indptr = structure.jacobian
        self._where = where
        self._jacobian_raw = self._derivatives[hessians:]
        count = len(structure.free)
        self.jacobian = sparse.csr_matrix((np.zeros(len(where)), indices, indptr), shape=(structure.row_count, count))
        self.transposed = self.jacobian.T
        """Jᵀ, on the same numbers"""
        self.kkt = np.zeros(len(structure.pattern[0]))
        """Nonzeros of K without Σ, δ and D"""
        self.cost = 0.0
        self.rows = np.zeros(structure.row_count)
        self.gradient = np.zeros(count)

    def load(self, problem: Problem) -> None:
        """Take over the numbers of a problem of this structure."""
        low, _ = problem.bounds
        self._full[:] = low  # constants; the others are overwritten
        for call in self._calls:
            call.load(problem)

    def values(self, x: Array) -> tuple[float, Array]:
        """f and (rows,) g at (free,) x."""
        self._full[self.structure.free] = x
        for call in self._calls:
            call.value(self._full)
        return float(self._values[self.structure.costs].sum()), self.structure.to_rows @ self._values

    def derivatives(self, x: Array, multipliers: Array) -> None:
        """Everything at (free,) x with (rows,) multipliers y."""
        self._full[self.structure.free] = x
        for call in self._calls:
            call.whole(self._full, multipliers)
        self.cost = float(self._values[self.structure.costs].sum())
        self.rows = self.structure.to_rows @ self._values
        self.gradient = self.structure.to_gradient @ self._jacobian_raw
        self.kkt = self.structure.to_kkt @ self._derivatives
        self.jacobian.data[:] = self.kkt[self._where]


class _Call:
    """One mapped kernel with its buffers."""

    def __init__(self, group: Group, values: Array, jacobian: Array, hessian: Array, native: bool) -> None:
        self.group = group
        n, (nv, np_, nr) = len(group.variables), group.kernel.sizes
        self._v, self._p, self._m = np.zeros((n, nv)), np.zeros((n, np_)), np.ones((n, nr))
        inputs, outputs = (self._v, self._p, self._m), (values, jacobian, hessian)
        self._whole = _mapped(group.kernel.whole, inputs, outputs, native)
        self._value = _mapped(group.kernel.value, inputs[:2], outputs[:1], native)

    def load(self, problem: Problem) -> None:
        np.concatenate([problem.terms[i].parameters for i in self.group.members], out=self._p)

    def value(self, full: Array) -> None:
        np.take(full, self.group.variables, out=self._v)
        self._value()

    def whole(self, full: Array, multipliers: Array) -> None:
        np.take(full, self.group.variables, out=self._v)
        if self.group.rows is not None:
            np.take(multipliers, self.group.rows, out=self._m)
        self._whole()


def _mapped(function: Any, inputs: tuple[Array, ...], outputs: tuple[Array, ...], native: bool) -> Callable[[], None]:
    """A call without arguments that reads (places, …) arrays and writes flat ones."""
    call = compiled_map(function, inputs, outputs) if native else None
    if call is not None:
        return call
    buffer, run = function.map(len(inputs[0])).buffer()  # CasADi's order: one column a place
    for i, array in enumerate(inputs):
        buffer.set_arg(i, array.reshape(-1).data)
    for i, array in enumerate(outputs):
        buffer.set_res(i, array.data)

    def interpreted(_kept: Any = (buffer, inputs, outputs)) -> None:
        run()

    return interpreted
