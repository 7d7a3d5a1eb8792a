r"""What is constant in a motion problem: which kernel writes where, found once per structure.

Problems with the same terms at the same places, the same constants and the same kinds of bounds share
one `Structure`, whatever their numbers are.  All instances of a kernel are one mapped call; its outputs
lie in flat arrays, and constant sparse matrices carry them into the vectors and the matrix

    K = [ H + Σ + δ_w I   Jᵀ         ]
        [ J               −δ_c I, −D ]

of which the upper triangle is stored by columns, variables first, rows after them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import blake2b
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from gaitforge.motion.problem import Kernel, Problem, Term

Array = NDArray[np.float64]
Index = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Group:
    """All instances of one kernel, of costs or of constraints."""

    kernel: Kernel
    members: tuple[int, ...]
    """Indices of its terms in `Problem.terms`"""
    variables: Index
    """(n, variables of the kernel) indices into the full vector"""
    rows: Index | None
    """(n, rows of the kernel); None: costs"""


@dataclass(frozen=True, eq=False)
class Structure:
    """Places, patterns and scatter matrices of one kind of problem."""

    size: int
    row_count: int
    free: Index
    """Free variables, as indices into the full vector"""
    groups: tuple[Group, ...]
    gather: Any
    """(1 + rows + free + nonzeros of K, raw values, Hessians and Jacobians): sums what the kernels give into the cost,
    the rows, the gradient of the cost and the matrix"""
    pattern: tuple[NDArray[np.int32], NDArray[np.int32]]
    """(indices, indptr) of the upper triangle of K by columns"""
    diagonal: Index
    """(free + rows,) where the diagonal of K stands among its nonzeros"""
    jacobian: tuple[Index, Index, Index]
    """(where in K, indices, indptr) of ∂g/∂x by columns of Jᵀ, which is by rows of J"""
    sizes: tuple[int, int, int]
    """Lengths of raw values, raw Jacobians and raw Hessians"""

    @property
    def dimension(self) -> int:
        """Free variables and rows."""
        return len(self.free) + self.row_count


def structure_key(problem: Problem) -> bytes:
    """A digest of all that a structure depends on; kernels count by identity."""
    low, high = problem.bounds
    digest = blake2b(np.array([problem.size, problem.row_count, len(problem.terms)]).tobytes(), digest_size=16)
    digest.update((low == high).tobytes())
    for term in problem.terms:
        digest.update(np.array([id(term.kernel), len(term.variables), term.rows is None]).tobytes())
        digest.update(term.variables.tobytes())
        if term.rows is not None:
            digest.update(term.rows.tobytes())
    return digest.digest()


def _grouped(terms: Sequence[Term]) -> tuple[Group, ...]:
    members: dict[tuple[int, bool], list[int]] = {}
    for i, term in enumerate(terms):
        members.setdefault((id(term.kernel), term.rows is None), []).append(i)
    groups = []
    for (_, cost), which in members.items():
        rows = None if cost else np.concatenate([terms[i].rows for i in which])
        variables = np.concatenate([terms[i].variables for i in which])
        groups.append(Group(terms[which[0]].kernel, tuple(which), variables, rows))
    return tuple(groups)


def analyse(problem: Problem) -> Structure:
    """Find where every kernel writes."""
    low, high = problem.bounds
    free = np.flatnonzero(low != high)
    position = np.full(problem.size, -1, dtype=np.intp)
    position[free] = np.arange(len(free))
    groups, count = _grouped(problem.terms), len(free)
    hessian, jacobian = _Triplets(), _Triplets()
    values, gradient = _Triplets(), _Triplets()
    for group in groups:
        a, b = group.kernel.hessian_rc
        first, second = position[group.variables[:, a]].ravel(), position[group.variables[:, b]].ravel()
        outside = (first < 0) | (second < 0)
        # two places of one instance that are the same variable: both halves fall on the diagonal
        twice = np.where((first == second) & np.tile(a != b, len(group.variables)), 2.0, 1.0)
        hessian.add(np.where(outside, -1, np.minimum(first, second)), np.maximum(first, second), twice)
        local_rows, local_columns = group.kernel.jacobian_rc
        columns = position[group.variables[:, local_columns]].ravel()
        nowhere = np.full(len(columns), -1)
        if group.rows is None:
            values.add(np.zeros(len(group.variables) * group.kernel.sizes[2], dtype=np.intp))
            gradient.add(np.where(columns < 0, -1, 1 + problem.row_count + columns))
            jacobian.add(nowhere, columns)
        else:
            values.add(1 + group.rows.ravel())
            gradient.add(nowhere)
            jacobian.add(columns, np.where(columns < 0, -1, count + group.rows[:, local_rows].ravel()))
    dimension = count + problem.row_count
    diagonal = np.arange(dimension)
    rows, columns, weights, source = _join(hessian, jacobian)
    cells = np.concatenate([columns * dimension + rows, diagonal * (dimension + 1)])
    unique, inverse = np.unique(cells, return_inverse=True)
    sizes = sum(values.lengths), sum(jacobian.lengths), sum(hessian.lengths)
    first = gradient.joined()[0]
    slopes = np.flatnonzero(first >= 0)
    targets = np.concatenate([values.joined()[0], first[slopes], 1 + dimension + inverse[: len(rows)]])
    sources = np.concatenate([np.arange(sizes[0]), sizes[0] + sizes[2] + slopes, sizes[0] + source])
    factors = np.concatenate([np.ones(sizes[0] + len(slopes)), weights])
    gather = sparse.csr_matrix((factors, (targets, sources)), shape=(1 + dimension + len(unique), sum(sizes)))
    indices, owner = unique % dimension, unique // dimension
    indptr = np.searchsorted(owner, np.arange(dimension + 1))
    entry = np.flatnonzero((owner >= count) & (indices < count))
    return Structure(
        size=problem.size,
        row_count=problem.row_count,
        free=free,
        groups=groups,
        gather=gather,
        pattern=(indices.astype(np.int32), indptr.astype(np.int32)),
        diagonal=inverse[len(rows) :],
        jacobian=(entry, indices[entry], np.searchsorted(owner[entry], count + np.arange(problem.row_count + 1))),
        sizes=sizes,
    )


class _Triplets:
    """Where a flat array of raw outputs goes: (row, column, weight) of every entry, −1: nowhere."""

    def __init__(self) -> None:
        self.rows: list[Index] = []
        self.columns: list[Index] = []
        self.weights: list[Array] = []

    def add(self, rows: Index, columns: Index | None = None, weights: Array | None = None) -> None:
        self.rows.append(rows)
        self.columns.append(rows if columns is None else columns)
        self.weights.append(np.ones(len(rows)) if weights is None else weights)

    @property
    def lengths(self) -> list[int]:
        return [len(r) for r in self.rows]

    def joined(self) -> tuple[Index, Index, Array]:
        none = np.zeros(0, dtype=np.intp)
        rows, columns = np.concatenate([none, *self.rows]), np.concatenate([none, *self.columns])
        return rows, columns, np.concatenate([np.zeros(0), *self.weights])


def _join(hessian: _Triplets, jacobian: _Triplets) -> tuple[Index, Index, Array, Index]:
    """Rows, columns, weights and sources of the entries of K that lie in it."""
    parts = [hessian.joined(), jacobian.joined()]
    rows, columns, weights = (np.concatenate(part) for part in zip(*parts, strict=True))
    source = np.flatnonzero((rows >= 0) & (columns >= 0))
    return rows[source], columns[source], weights[source], source
