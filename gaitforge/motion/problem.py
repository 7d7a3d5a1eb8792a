r"""A sparse nonlinear program put together from many copies of small functions.

    minimise  Σ_t Σ_i f_t(v_ti, p_ti)   subject to   l ≤ Σ_t scatter(r_t(v_ti, p_ti)) ≤ u,  lx ≤ x ≤ ux

Every *term* t is one small function of a few variables (one limb at one sample, say), compiled once,
and instantiated at many places i; its rows add up where instances name the same row.  Values,
gradients and exact Hessians of the whole are constant sparse matrices times the mapped outputs of
these functions, so nothing large is ever differentiated, and a problem is ready in milliseconds.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Builder = Callable[[Any, Any], Any]
Deriver = Callable[[Any, Any, Any], tuple[Any, Any]]


class Kernel:
    """A small function r(v, p) with its Jacobian's nonzeros and the Hessian's of λ·r, ready to map."""

    def __init__(self, variables: int, parameters: int, build: Builder, derive: Deriver | None = None) -> None:
        import casadi as ca

        self._v, self._p = ca.SX.sym("v", variables), ca.SX.sym("p", parameters)
        self._r: Any = ca.densify(build(self._v, self._p))
        self.sizes = (variables, parameters, int(self._r.shape[0]))
        """(variables, parameters, rows)"""
        self._multiplier = ca.SX.sym("m", self.sizes[2])
        if derive is None:
            jacobian: Any = ca.jacobian(self._r, self._v)
            hessian: Any = ca.triu(ca.hessian(ca.dot(self._multiplier, self._r), self._v)[0])
        else:
            first, second = derive(self._v, self._p, self._multiplier)
            jacobian, hessian = ca.sparsify(first), ca.sparsify(second)
        self._jacobian, self._hessian = _nonzeros(jacobian), _nonzeros(hessian)
        self.jacobian_rc: tuple[Index, Index] = _triplets(jacobian)
        self.hessian_rc: tuple[Index, Index] = _triplets(hessian)

    @cached_property
    def value(self) -> Any:
        """(v, p) → r"""
        return self._function("value", [self._v, self._p], [self._r])

    @cached_property
    def first(self) -> Any:
        """(v, p) → r and the nonzeros of ∂r/∂v"""
        return self._function("first", [self._v, self._p], [self._r, self._jacobian])

    @cached_property
    def second(self) -> Any:
        """(v, p, λ) → the nonzeros of the upper triangle of ∇² λ·r"""
        return self._function("second", [self._v, self._p, self._multiplier], [self._hessian])

    @cached_property
    def whole(self) -> Any:
        """(v, p, λ) → r, the nonzeros of ∂r/∂v and those of the upper triangle of ∇² λ·r"""
        inputs = [self._v, self._p, self._multiplier]
        return self._function("whole", inputs, [self._r, self._jacobian, self._hessian])

    @staticmethod
    def _function(name: str, inputs: list[Any], outputs: list[Any]) -> Any:
        import casadi as ca

        return ca.Function(name, inputs, outputs)


_kernels: dict[Any, Kernel] = {}


def kernel(key: Any, variables: int, parameters: int, build: Builder, derive: Deriver | None = None) -> Kernel:
    """Compile `build(v, p)` (CasADi SX column vectors in and out), once per key and process.

    `derive(v, p, λ)` gives ∂r/∂v and the upper triangle of ∇² λ·r where someone knows them better than
    automatic differentiation does.
    """
    full = (key, variables, parameters)
    if full not in _kernels:
        _kernels[full] = Kernel(variables, parameters, build, derive)
    return _kernels[full]


def _filled(values: ArrayLike, shape: tuple[int, ...]) -> Array:
    """A new flat array of a shape, from values that broadcast to it."""
    out = np.empty(shape)
    out[...] = values
    return out.ravel()


def _nonzeros(matrix: Any) -> Any:
    import casadi as ca

    return ca.vertcat(*matrix.nonzeros()) if matrix.nnz() else ca.SX.zeros(0, 1)


def _triplets(matrix: Any) -> tuple[Index, Index]:
    rows, columns = matrix.sparsity().get_triplet()
    return np.array(rows, dtype=np.intp), np.array(columns, dtype=np.intp)


@dataclass(frozen=True, eq=False)
class Term:
    """One kernel at many places."""

    family: str
    kernel: Kernel
    variables: Index
    """(instances, kernel variables) indices into the full variable vector"""
    parameters: Array
    """(instances, kernel parameters)"""
    rows: Index | None
    """(instances, kernel rows) constraint rows to add to; None: a cost"""


@dataclass
class Rows:
    """A block of constraint rows of one family, with what each row speaks of."""

    family: str
    start: int
    lower: Array
    upper: Array
    unit: str
    spoken_of: Sequence[Any]
    """A label for every `len(lower) / len(spoken_of)` rows"""

    @cached_property
    def labels(self) -> tuple[Any, ...]:
        """What each row speaks of."""
        each = len(self.lower) // max(len(self.spoken_of), 1)
        return tuple(label for label in self.spoken_of for _ in range(each))


@dataclass
class Problem:
    """Variables, rows and terms; filled by the families, solved by a solver, asked by explanations."""

    guess: list[Array] = field(default_factory=list)
    lower: list[Array] = field(default_factory=list)
    upper: list[Array] = field(default_factory=list)
    rows: list[Rows] = field(default_factory=list)
    terms: list[Term] = field(default_factory=list)
    size: int = 0
    row_count: int = 0

    def add_variables(self, guess: ArrayLike, lower: ArrayLike, upper: ArrayLike) -> Index:
        """New variables in the shape of `guess`; where lower equals upper they are constants."""
        start = np.array(guess, dtype=float)
        self.guess.append(start.ravel())
        self.lower.append(_filled(lower, start.shape))
        self.upper.append(_filled(upper, start.shape))
        index = np.arange(self.size, self.size + start.size, dtype=np.intp).reshape(start.shape)
        self.size += start.size
        return index

    def add_rows(
        self, family: str, lower: ArrayLike, upper: ArrayLike, shape: tuple[int, ...], unit: str, labels: Sequence[Any]
    ) -> Index:
        """New constraint rows; `labels` has one entry per first index of `shape`."""
        count = math.prod(shape)
        low, high = _filled(lower, shape), _filled(upper, shape)
        self.rows.append(Rows(family, self.row_count, low, high, unit, labels))
        index = np.arange(self.row_count, self.row_count + count, dtype=np.intp).reshape(shape)
        self.row_count += count
        return index

    def add_term(
        self,
        family: str,
        compiled: Kernel,
        variables: ArrayLike,
        parameters: ArrayLike,
        rows: ArrayLike | None = None,
    ) -> None:
        """Instances of a kernel: (n, nv) variables, (n, np) parameters, (n, nr) rows or None for a cost."""
        v = np.asarray(variables, dtype=np.intp).reshape(-1, compiled.sizes[0])
        p = _filled(parameters, (len(v), compiled.sizes[1])).reshape(len(v), compiled.sizes[1])
        r = None if rows is None else np.asarray(rows, dtype=np.intp).reshape(len(v), compiled.sizes[2])
        if len(v):
            self.terms.append(Term(family, compiled, v, p, r))

    # -- vectors ---------------------------------------------------------------------------
    @property
    def x0(self) -> Array:
        """(size,) the starting point."""
        return np.concatenate(self.guess)

    @property
    def bounds(self) -> tuple[Array, Array]:
        """(size,) lower and upper bounds of the variables."""
        return np.concatenate(self.lower), np.concatenate(self.upper)

    @property
    def row_bounds(self) -> tuple[Array, Array]:
        """(row_count,) lower and upper bounds of the rows."""
        none = [np.zeros(0)]
        lower, upper = [r.lower for r in self.rows], [r.upper for r in self.rows]
        return np.concatenate(none + lower), np.concatenate(none + upper)

    def constraint_values(self, x: Array) -> Array:
        """(row_count,) the rows at x, without any solver."""
        values = np.zeros(self.row_count)
        for term in self.terms:
            if term.rows is not None:
                out = term.kernel.value.map(len(term.variables))(x[term.variables].T, term.parameters.T)
                np.add.at(values, term.rows, np.array(out).T)
        return values

    def violations(self, x: Array, values: Array | None = None) -> dict[str, tuple[float, Any, str]]:
        """Per family: the largest violation, the label of its row, the unit; `values`: the rows at x if known."""
        values = self.constraint_values(x) if values is None else values
        worst: dict[str, tuple[float, Any, str]] = {}
        for block in self.rows:
            part = values[block.start : block.start + len(block.lower)]
            excess = np.maximum(block.lower - part, part - block.upper)
            if len(excess) and excess.max() > worst.get(block.family, (-np.inf,))[0]:
                at = int(excess.argmax())
                worst[block.family] = (float(excess[at]), block.labels[at], block.unit)
        low, high = self.bounds
        outside = np.maximum(low - x, x - high)
        if len(outside):
            worst["bounds"] = (float(outside.max()), int(outside.argmax()), "")
        return worst
