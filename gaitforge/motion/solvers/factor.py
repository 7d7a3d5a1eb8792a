"""LDLᵀ of the KKT matrix on a pattern that stays, with its inertia."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from gaitforge.motion.solvers.native import library
from gaitforge.motion.solvers.supernodal import Supernodal
from gaitforge.motion.solvers.supernodes import find_supernodes

Array = NDArray[np.float64]
Ints = NDArray[np.int32]


class Factor(Protocol):
    """LDLᵀ of a symmetric matrix whose pattern was given before."""

    def factor(self, values: Array) -> int | None:
        """Factor K with these nonzeros (upper triangle by columns); its number of negative pivots, None on failure."""
        ...

    def solve(self, right: Array) -> Array:
        """K⁻¹ right, for the values factored last."""
        ...


def factor_of(indices: Ints, indptr: Ints, native: bool) -> Factor:
    """The compiled factorisation where it is wanted and there is a compiler, qdldl elsewhere."""
    numeric, symbolic = (library(name) if native else None for name in ("ldl.c", "symbolic.c"))
    if numeric is None or symbolic is None:
        return Qdldl(indices, indptr)
    return Supernodal(find_supernodes(indices, indptr, minimum_degree(indices, indptr), symbolic), numeric)


def minimum_degree(indices: Ints, indptr: Ints) -> Ints:
    """(n,) an ordering with little fill: approximate minimum degree (Amestoy, Davis & Duff 1996) by CasADi.

    The diagonal is given whole: the algorithm needs n entries to move things about in, and CasADi's has no others
    than those of the diagonal, which it drops; without them it writes where it must not.
    """
    import casadi as ca

    size = len(indptr) - 1
    upper = ca.Sparsity(size, size, indptr.tolist(), indices.tolist()).unite(ca.Sparsity.diag(size))
    return np.array(upper.unite(upper.T).amd(), dtype=np.int32)


class Qdldl:
    """qdldl: quasi-definite LDLᵀ with AMD, ordered once and refactored in place."""

    def __init__(self, indices: Ints, indptr: Ints) -> None:
        dimension = len(indptr) - 1
        self._matrix = sparse.csc_matrix((np.zeros(len(indices)), indices, indptr), shape=(dimension, dimension))
        self._solver: Any = None

    def factor(self, values: Array) -> int | None:
        """Factor K with these nonzeros (upper triangle by columns); its number of negative pivots, None on failure."""
        import qdldl

        self._matrix.data[:] = values
        try:
            if self._solver is None:
                self._solver = qdldl.Solver(self._matrix, upper=True)
            else:
                self._solver.update(self._matrix, upper=True)
        except (RuntimeError, ValueError):  # a pivot of zero
            self._solver = None
            return None
        pivots = self._solver.factors()[1]
        return int((pivots < 0).sum()) if np.isfinite(pivots).all() else None

    def solve(self, right: Array) -> Array:
        """K⁻¹ right, for the values factored last."""
        return np.asarray(self._solver.solve(right))
