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
Index = NDArray[np.intp]


class Evaluation:
    """f, g, ∇f, J and the upper triangle of ∇²L + the rows of J as nonzeros of K, at the last point asked for.

    L = f + yᵀ g.  Arrays are overwritten by the next call.
    """

    def __init__(self, structure: Structure, native: bool = True) -> None:
        self.structure = structure
        values, jacobians, hessians = structure.sizes
        self._raw = np.zeros(values + hessians + jacobians)
        raw_values, derivatives = self._raw[:values], self._raw[values:]
        self._full = np.zeros(structure.size)
        # all that kernels read, gathered at once: variables, and multipliers with a last one of 1 for costs
        self._multipliers = np.ones(structure.row_count + 1)
        none = np.zeros(0, dtype=np.intp)
        self._places = np.concatenate([none, *(g.variables.ravel() for g in structure.groups)])
        self._weights = np.concatenate([none, *(_rows_of(g, structure.row_count) for g in structure.groups)])
        self._v, self._m = np.zeros(len(self._places)), np.zeros(len(self._weights))
        self._calls: list[_Call] = []
        at = [0, 0, 0, hessians, 0]
        for group in structure.groups:
            n, (nv, _, nr) = len(group.variables), group.kernel.sizes
            nonzeros = [len(group.kernel.jacobian_rc[0]), len(group.kernel.hessian_rc[0])]
            ends = [a + n * each for a, each in zip(at, (nv, nr, nr, *nonzeros), strict=True)]
            v, m, r, j, h = (slice(*ends_of) for ends_of in zip(at, ends, strict=True))
            out = (raw_values[r], derivatives[j], derivatives[h])
            read = (self._v[v].reshape(n, nv), self._m[m].reshape(n, nr))
            self._calls.append(_Call(group, read, out, native))
            at = ends
        where, indices, indptr = structure.jacobian
        self._where = where
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
        self._full.take(self._places, out=self._v)
        for call in self._calls:
            call.value()
        cost, rows, _, _ = self._gathered()
        return cost, rows

    def derivatives(self, x: Array, multipliers: Array) -> None:
        """Everything at (free,) x with (rows,) multipliers y."""
        self._full[self.structure.free] = x
        self._full.take(self._places, out=self._v)
        self._multipliers[:-1] = multipliers
        self._multipliers.take(self._weights, out=self._m)
        for call in self._calls:
            call.whole()
        self.cost, self.rows, self.gradient, self.kkt = self._gathered()
        self.kkt.take(self._where, out=self.jacobian.data)

    def _gathered(self) -> tuple[float, Array, Array, Array]:
        """Cost, rows, gradient and nonzeros of K from what the kernels gave last."""
        found, rows, dimension = self.structure.gather @ self._raw, self.structure.row_count, self.structure.dimension
        return float(found[0]), found[1 : 1 + rows], found[1 + rows : 1 + dimension], found[1 + dimension :]


def _rows_of(group: Group, none: int) -> Index:
    """Which multiplier each output of a kernel has; `none` for costs."""
    count = len(group.variables) * group.kernel.sizes[2]
    return np.full(count, none, dtype=np.intp) if group.rows is None else group.rows.ravel()


class _Call:
    """One mapped kernel with its buffers."""

    def __init__(
        self, group: Group, read: tuple[Array, Array], outputs: tuple[Array, Array, Array], native: bool
    ) -> None:
        self.group = group
        variables, multipliers = read
        self._p = np.zeros((len(variables), group.kernel.sizes[1]))
        inputs = (variables, self._p, multipliers)
        compiled = compiled_map(group.kernel, inputs, outputs) if native else None
        self.whole = compiled or _interpreted(group.kernel.whole, inputs, outputs)
        # compiled code finds derivatives sooner than an interpreter the values alone
        self.value = compiled or _interpreted(group.kernel.value, inputs[:2], outputs[:1])

    def load(self, problem: Problem) -> None:
        np.concatenate([problem.terms[i].parameters for i in self.group.members], out=self._p)


def _interpreted(function: Any, inputs: tuple[Array, ...], outputs: tuple[Array, ...]) -> Callable[[], None]:
    """A call without arguments that reads (places, …) arrays and writes flat ones."""
    buffer, run = function.map(len(inputs[0])).buffer()  # CasADi's order: one column a place
    for i, array in enumerate(inputs):
        buffer.set_arg(i, array.reshape(-1).data)
    for i, array in enumerate(outputs):
        buffer.set_res(i, array.data)

    def call(_kept: Any = (buffer, inputs, outputs)) -> None:
        run()

    return call
