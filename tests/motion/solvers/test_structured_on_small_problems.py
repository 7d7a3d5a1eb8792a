"""Small problems with published or countable answers, put together from kernels as the big ones are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
import pytest

from gaitforge.motion.problem import Problem, kernel
from gaitforge.motion.solvers.factor import Qdldl
from gaitforge.motion.solvers.ipopt import Ipopt
from gaitforge.motion.solvers.solution import Solution
from gaitforge.motion.solvers.structured import Structured

ALONE = Structured(restoration=False, fallback=None, residual=1e-9, gap=1e-6)
INF = np.inf


@dataclass(frozen=True)
class Published:
    """A problem of Hock and Schittkowski, Test Examples for Nonlinear Programming Codes (1981)."""

    start: list[float]
    cost: Any
    best: float
    at: list[float] | None = None
    lower: Any = -INF
    upper: Any = INF
    rows: Any = None
    row_lower: Any = ()
    row_upper: Any = ()

    def problem(self, name: str) -> Problem:
        problem = Problem()
        x = problem.add_variables(self.start, self.lower, self.upper)
        problem.add_term("cost", kernel(("hs", name, "f"), len(x), 0, lambda v, p: self.cost(v)), x[None], np.zeros(0))
        if self.rows is not None:
            count = len(self.row_lower)
            rows = problem.add_rows("rows", [self.row_lower], [self.row_upper], (1, count), "", ["all"])
            compiled = kernel(("hs", name, "g"), len(x), 0, lambda v, p: ca.vertcat(*self.rows(v)))
            problem.add_term("rows", compiled, x[None], np.zeros(0), rows)
        return problem


PUBLISHED = {
    "1": Published(
        [-2, 1], lambda v: 100 * (v[1] - v[0] ** 2) ** 2 + (1 - v[0]) ** 2, 0.0, [1, 1], lower=[-INF, -1.5]
    ),
    "6": Published(
        [-1.2, 1], lambda v: (1 - v[0]) ** 2, 0.0, [1, 1], rows=lambda v: [10 * (v[1] - v[0] ** 2)],
        row_lower=[0], row_upper=[0],
    ),
    "7": Published(
        [2, 2], lambda v: ca.log(1 + v[0] ** 2) - v[1], -np.sqrt(3.0), [0, np.sqrt(3.0)],
        rows=lambda v: [(1 + v[0] ** 2) ** 2 + v[1] ** 2], row_lower=[4], row_upper=[4],
    ),
    "10": Published(
        [-10, 10], lambda v: v[0] - v[1], -1.0, [0, 1],
        rows=lambda v: [-3 * v[0] ** 2 + 2 * v[0] * v[1] - v[1] ** 2 + 1], row_lower=[0], row_upper=[INF],
    ),
    "11": Published(
        [4.9, 0.1], lambda v: (v[0] - 5) ** 2 + v[1] ** 2 - 25, -8.498464223,
        rows=lambda v: [-v[0] ** 2 + v[1]], row_lower=[0], row_upper=[INF],
    ),
    "26": Published(
        [-2.6, 2, 2], lambda v: (v[0] - v[1]) ** 2 + (v[1] - v[2]) ** 4, 0.0,
        rows=lambda v: [(1 + v[1] ** 2) * v[0] + v[2] ** 4], row_lower=[3], row_upper=[3],
    ),
    "35": Published(
        [0.5, 0.5, 0.5],
        lambda v: 9 - 8 * v[0] - 6 * v[1] - 4 * v[2] + 2 * v[0] ** 2 + 2 * v[1] ** 2 + v[2] ** 2
        + 2 * v[0] * v[1] + 2 * v[0] * v[2],
        1 / 9, [4 / 3, 7 / 9, 4 / 9], lower=0, rows=lambda v: [3 - v[0] - v[1] - 2 * v[2]],
        row_lower=[0], row_upper=[INF],
    ),
    "43": Published(
        [0, 0, 0, 0],
        lambda v: v[0] ** 2 + v[1] ** 2 + 2 * v[2] ** 2 + v[3] ** 2 - 5 * v[0] - 5 * v[1] - 21 * v[2] + 7 * v[3],
        -44.0, [0, 1, 2, -1],
        rows=lambda v: [
            8 - v[0] ** 2 - v[1] ** 2 - v[2] ** 2 - v[3] ** 2 - v[0] + v[1] - v[2] + v[3],
            10 - v[0] ** 2 - 2 * v[1] ** 2 - v[2] ** 2 - 2 * v[3] ** 2 + v[0] + v[3],
            5 - 2 * v[0] ** 2 - v[1] ** 2 - v[2] ** 2 - 2 * v[0] + v[1] + v[3],
        ],
        row_lower=[0, 0, 0], row_upper=[INF, INF, INF],
    ),
    "71": Published(
        [1, 5, 5, 1], lambda v: v[0] * v[3] * (v[0] + v[1] + v[2]) + v[2], 17.0140173,
        [1, 4.7429994, 3.8211503, 1.3794082], lower=1, upper=5,
        rows=lambda v: [v[0] * v[1] * v[2] * v[3], ca.sumsqr(v)], row_lower=[25, 40], row_upper=[INF, 40],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", PUBLISHED)
def test_published_optima_are_found(name: str) -> None:
    case = PUBLISHED[name]
    solution = ALONE.solve(case.problem(name))
    assert solution.solved, solution.status
    assert solution.cost == pytest.approx(case.best, rel=1e-6, abs=1e-6)
    assert solution.residual < 1e-8
    if case.at is not None:
        assert solution.x == pytest.approx(case.at, abs=1e-4)


def test_a_row_between_two_bounds_holds_at_either() -> None:
    for pull, expected in ((-9.0, -2.0), (9.0, 3.0), (1.0, 1.0)):
        problem = Problem()
        x = problem.add_variables([0.0, 0.0], -INF, INF)
        rows = problem.add_rows("sum", -2.0, 3.0, (1, 1), "", ["all"])
        problem.add_term("sum", kernel("two_sided", 2, 0, lambda v, p: v[0] + v[1]), x[None], np.zeros(0), rows)
        near = kernel("two_sided_near", 2, 1, lambda v, p: ca.sumsqr(v - p[0] / 2))
        problem.add_term("near", near, x[None], [pull])
        solution = ALONE.solve(problem)
        assert solution.solved
        assert solution.x.sum() == pytest.approx(expected, abs=1e-6)
        assert solution.multipliers is not None
        assert solution.multipliers.rows[0] == pytest.approx(pull - expected, abs=1e-5), "2 (x_i − pull/2) + λ = 0"


def test_an_indefinite_hessian_leads_to_the_minimum_and_not_to_the_saddle() -> None:
    # x² − y² + y⁴ / 2 has a saddle at 0 and minima at y = ±1; plain Newton steps from here go to the saddle
    problem = Problem()
    x = problem.add_variables([0.3, 0.2], -INF, INF)
    problem.add_term("f", kernel("saddle", 2, 0, lambda v, p: v[0] ** 2 - v[1] ** 2 + v[1] ** 4 / 2), x[None], [])
    solution = ALONE.solve(problem)
    assert solution.solved
    assert solution.x == pytest.approx([0.0, 1.0], abs=1e-5)
    assert solution.cost == pytest.approx(-0.5)


def test_negative_pivots_are_the_negative_eigenvalues() -> None:
    rng = np.random.default_rng(3)
    for _ in range(20):
        size = int(rng.integers(2, 9))
        full = rng.normal(size=(size, size))
        full = full + full.T + np.diag(rng.normal(0, 3, size))
        rows, columns = np.triu_indices(size)
        order = np.lexsort((rows, columns))
        indptr = np.concatenate([[0], np.cumsum(np.arange(1, size + 1))]).astype(np.int32)
        factor = Qdldl(rows[order].astype(np.int32), indptr)
        assert factor.factor(full[rows, columns][order]) == (np.linalg.eigvalsh(full) < 0).sum()
        right = rng.normal(size=size)
        assert full @ factor.solve(right) == pytest.approx(right, abs=1e-6)


def impossible(times: int = 1) -> Problem:
    """x² ≤ −1, as often as asked, and x + y = 1."""
    problem = Problem()
    x = problem.add_variables([1.0, 0.5], -INF, INF)
    square = kernel("impossible", 1, 0, lambda v, p: v[0] ** 2)
    for _ in range(times):
        rows = problem.add_rows("square", -INF, -1.0, (1, 1), "m²", ["everywhere"])
        problem.add_term("square", square, x[:1, None], np.zeros(0), rows)
    fine = problem.add_rows("sum", 1.0, 1.0, (1, 1), "m", ["here"])
    problem.add_term("sum", kernel("possible", 2, 0, lambda v, p: v[0] + v[1]), x[None], np.zeros(0), fine)
    return problem


def test_what_cannot_be_met_is_given_up_soon_and_named() -> None:
    solution = ALONE.solve(impossible())
    assert not solution.solved
    assert solution.status in ("stalled", "singular")
    assert solution.iterations <= 30
    family, (value, label, unit) = max(solution.worst.items(), key=lambda item: item[1][0])
    assert (family, label, unit) == ("square", "everywhere", "m²")
    assert value >= 1.0


class Recorder:
    """A fallback that says that it was asked."""

    def __init__(self) -> None:
        self.asked = 0

    def solve(self, problem: Problem, start: Any = None) -> Solution:
        self.asked += 1
        return Ipopt(max_iterations=20).solve(problem, start)


def test_the_fallback_is_asked_after_a_failure_only() -> None:
    recorder = Recorder()
    solver = Structured(restoration=False, fallback=recorder)
    assert solver.solve(PUBLISHED["71"].problem("71")).solved
    assert recorder.asked == 0
    failed = solver.solve(impossible())
    assert recorder.asked == 1
    assert not failed.solved
    assert "structured: " in failed.status
    tired = Structured(max_iterations=2, restoration=False, fallback=recorder).solve(PUBLISHED["71"].problem("71"))
    assert recorder.asked == 2
    assert tired.solved
    assert tired.cost == pytest.approx(17.0140173, rel=1e-6)
    assert tired.iterations > 2


@pytest.mark.parametrize(("times", "asked"), [(1, 1), (6, 0)])
def test_a_failure_says_what_is_in_the_way_and_the_fallback_is_asked_where_that_is_little(
    times: int, asked: int
) -> None:
    recorder = Recorder()
    failed = Structured(fallback=recorder).solve(impossible(times))
    assert not failed.solved
    assert recorder.asked == asked
    assert [(v.family, v.label) for v in failed.violations or ()] == times * [("square", "everywhere")]
    assert abs((failed.violations or ())[0].amount) == pytest.approx(1.0, abs=1e-3)


def test_a_failure_of_a_problem_without_rows_is_a_failure() -> None:
    failed = Structured(max_iterations=0, fallback=None).solve(bounded_only())
    assert not failed.solved
    assert failed.violations == []


def bounded_only() -> Problem:
    problem = Problem()
    x = problem.add_variables([9.0, 3.0], [-10.0, -10.0], [10.0, 10.0])
    build = kernel("bounded_only", 2, 0, lambda v, p: (v[0] ** 2 + v[1] - 11) ** 2 + (v[0] + v[1] ** 2 - 7) ** 2)
    problem.add_term("f", build, x[None], np.zeros(0))
    return problem


def test_a_fixed_variable_stays_at_its_bound() -> None:
    problem = Problem()
    x = problem.add_variables([9.0, 3.0], [2.0, -INF], [2.0, INF])
    problem.add_term("f", kernel("fixed", 2, 0, lambda v, p: (v[0] * v[1] - 8) ** 2), x[None], np.zeros(0))
    solution = ALONE.solve(problem)
    assert solution.solved
    assert solution.x == pytest.approx([2.0, 4.0], abs=1e-5)
    assert solution.x[0] == 2.0
