"""The CasADi functions f, ∇f, g, ∂g/∂x and ∇²L of a `Problem`, over its free variables only."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.problem import Problem, Term

Array = NDArray[np.float64]
Index = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Assembled:
    """What an NLP solver needs; x here holds the free variables only."""

    free: Index
    """Positions of the free variables in the full vector."""
    nlp: dict[str, Any]
    """x, f, g as CasADi expressions."""
    options: dict[str, Any]
    """Exact derivative functions by the names that CasADi's `nlpsol` takes."""

    def expand(self, problem: Problem, x: Array) -> Array:
        """The full variable vector."""
        low, high = problem.bounds
        full = np.where(low == high, low, problem.x0)
        full[self.free] = x
        return full


def assemble(problem: Problem) -> Assembled:
    """Build f, g and their exact derivatives as sparse combinations of mapped kernels."""
    import casadi as ca

    low, high = problem.bounds
    fixed = low == high
    free = np.flatnonzero(~fixed)
    position = np.full(problem.size, -1, dtype=np.intp)
    position[free] = np.arange(len(free))
    x = ca.MX.sym("x", len(free))
    place = np.where(fixed, len(free) + np.cumsum(fixed) - 1, position)
    full = ca.vertcat(x, ca.MX(ca.DM(low[fixed]))) if fixed.any() else x
    builder = _Builder(problem, full, place, position, len(free))
    parameter = ca.MX.sym("p", 0)
    f, g = builder.cost(), builder.constraints()
    multiplier_f, multiplier_g = ca.MX.sym("lam_f"), ca.MX.sym("lam_g", problem.row_count)
    functions = {
        "grad_f": ca.Function("nlp_grad_f", [x, parameter], [f, builder.gradient()], ["x", "p"], ["f", "grad_f_x"]),
        "jac_g": ca.Function("nlp_jac_g", [x, parameter], [g, builder.jacobian()], ["x", "p"], ["g", "jac_g_x"]),
        "hess_lag": ca.Function(
            "nlp_hess_l",
            [x, parameter, multiplier_f, multiplier_g],
            [builder.hessian(multiplier_f, multiplier_g)],
            ["x", "p", "lam_f", "lam_g"],
            ["triu_hess_gamma_x_x"],
        ),
    }
    return Assembled(free, {"x": x, "p": parameter, "f": f, "g": g}, functions)


class _Builder:
    """Maps every kernel once per kind of derivative and scatters the outputs."""

    def __init__(self, problem: Problem, full: Any, place: Index, position: Index, free: int) -> None:
        import casadi as ca

        self.problem, self.position, self.free = problem, position, free
        self.inputs = []
        for term in problem.terms:
            gathered = full[place[term.variables].ravel().tolist()]
            v = ca.reshape(gathered, term.variables.shape[1], term.variables.shape[0])
            self.inputs.append((term, v, ca.MX(ca.DM(term.parameters.T))))

    def cost(self) -> Any:
        import casadi as ca

        total: Any = ca.MX(0)
        for term, v, p in self.inputs:
            if term.rows is None:
                total = total + ca.sum2(ca.sum1(term.kernel.value.map(len(term.variables))(v, p)))
        return total

    def constraints(self) -> Any:
        import casadi as ca

        parts, targets = [], []
        for term, v, p in self.inputs:
            if term.rows is not None:
                parts.append(ca.vec(term.kernel.value.map(len(term.variables))(v, p)))
                targets.append(term.rows.ravel())
        return _scatter(parts, targets, self.problem.row_count)

    def _first(self, costs: bool) -> tuple[list[Any], list[Index], list[Index]]:
        import casadi as ca

        parts, rows, columns = [], [], []
        for term, v, p in self.inputs:
            local_rows, local_columns = term.kernel.jacobian_rc
            if (term.rows is None) == costs and len(local_rows):
                parts.append(ca.vec(term.kernel.first.map(len(term.variables))(v, p)[1]))
                rows.append(
                    np.zeros(len(local_rows) * len(term.variables), dtype=np.intp)
                    if term.rows is None
                    else term.rows[:, local_rows].ravel()
                )
                columns.append(self.position[term.variables[:, local_columns]].ravel())
        return parts, rows, columns

    def gradient(self) -> Any:
        parts, _, columns = self._first(costs=True)
        return _scatter(parts, columns, self.free)

    def jacobian(self) -> Any:
        parts, rows, columns = self._first(costs=False)
        return _sparse(parts, rows, columns, (self.problem.row_count, self.free))

    def hessian(self, multiplier_f: Any, multiplier_g: Any) -> Any:
        import casadi as ca

        parts, rows, columns, weights = [], [], [], []
        for term, v, p in self.inputs:
            a, b = term.kernel.hessian_rc
            if not len(a):
                continue
            count = len(term.variables)
            multiplier = self._multipliers(term, multiplier_f, multiplier_g)
            parts.append(ca.vec(term.kernel.second.map(count)(v, p, multiplier)))
            first, second = self.position[term.variables[:, a]].ravel(), self.position[term.variables[:, b]].ravel()
            keep = (first >= 0) & (second >= 0)
            rows.append(np.where(keep, np.minimum(first, second), -1))
            columns.append(np.where(keep, np.maximum(first, second), -1))
            # two places of one instance that are the same variable: both halves fall on the diagonal
            weights.append(np.where((first == second) & np.tile(a != b, count), 2.0, 1.0))
        return _sparse(parts, rows, columns, (self.free, self.free), weights)

    def _multipliers(self, term: Term, multiplier_f: Any, multiplier_g: Any) -> Any:
        import casadi as ca

        count, size = len(term.variables), term.kernel.sizes[2]
        if term.rows is None:
            return ca.repmat(multiplier_f, size, count)
        return ca.reshape(multiplier_g[term.rows.ravel().tolist()], size, count)


def _scatter(parts: list[Any], targets: list[Index], size: int) -> Any:
    """Vector of `size` entries in which the parts' entries are added at their targets (−1: dropped)."""
    import casadi as ca

    if not parts:
        return ca.MX.zeros(size, 1)
    target = np.concatenate(targets)
    source = np.flatnonzero(target >= 0)
    matrix = _constant(target[source], source, (size, len(target)))
    return ca.densify(ca.mtimes(matrix, ca.vertcat(*parts)))  # a sparse gradient would be misread by the solver


def _sparse(
    parts: list[Any],
    rows: list[Index],
    columns: list[Index],
    shape: tuple[int, int],
    weights: list[Array] | None = None,
) -> Any:
    """Sparse matrix in which the parts' entries are added at (row, column); negative indices are dropped."""
    import casadi as ca

    if not parts:
        return ca.MX(*shape)
    row, column = np.concatenate(rows), np.concatenate(columns)
    source = np.flatnonzero((row >= 0) & (column >= 0))
    cells = column[source] * shape[0] + row[source]  # column-major, CasADi's order
    unique, inverse = np.unique(cells, return_inverse=True)
    pattern = ca.Sparsity.triplet(shape[0], shape[1], (unique % shape[0]).tolist(), (unique // shape[0]).tolist())
    weight = None if weights is None else np.concatenate(weights)[source]
    matrix = _constant(inverse, source, (len(unique), len(row)), weight)
    return ca.MX(pattern, ca.mtimes(matrix, ca.vertcat(*parts)))


def _constant(rows: Index, columns: Index, shape: tuple[int, int], values: Array | None = None) -> Any:
    import casadi as ca

    entries = np.ones(len(rows)) if values is None else values
    return ca.MX(ca.DM.triplet(rows.tolist(), columns.tolist(), ca.DM(entries), shape[0], shape[1]))
