"""The sparse problem: scatter and exact derivatives on instances small enough to check by hand."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest

from gaitforge.motion.assembly import Assembled, assemble
from gaitforge.motion.problem import Problem, kernel
from gaitforge.motion.solvers.ipopt import Ipopt

FREE = (-np.inf, np.inf)


def product(v: Any, p: Any) -> Any:
    return p[0] * v[0] * v[1]


def square(v: Any, p: Any) -> Any:
    return p[0] * (v[0] - p[1]) ** 2


def cross(v: Any, p: Any) -> Any:
    return ca.vertcat(v[0] * v[1] + v[1] ** 3, ca.sin(v[0]))


def derivatives(problem: Problem, x: np.ndarray, lam_f: float, lam_g: np.ndarray) -> tuple[Assembled, dict[str, Any]]:
    """f, ∇f, g, J and the full symmetric Hessian at the free variables x."""
    built = assemble(problem)
    f, gradient = built.options["grad_f"](x, [])
    g, jacobian = built.options["jac_g"](x, [])
    upper = np.array(ca.DM(built.options["hess_lag"](x, [], lam_f, lam_g)))
    assert not np.tril(upper, -1).any()
    values = {
        "f": float(f),
        "gradient": np.array(ca.DM(gradient)).ravel(),
        "g": np.array(ca.DM(g)).ravel(),
        "jacobian": np.array(ca.DM(jacobian)),
        "hessian": upper + np.triu(upper, 1).T,
    }
    return built, values


def test_rows_that_several_terms_name_add_up() -> None:
    problem = Problem()
    a = problem.add_variables([2.0, 3.0, 5.0], *FREE)
    row = problem.add_rows("sum", 0.0, 0.0, (1, 1), "m", ["all"])
    compiled = kernel("test_product", 2, 1, product)
    problem.add_term("sum", compiled, [[a[0], a[1]], [a[1], a[2]]], [[1.0], [10.0]], np.vstack([row, row]))
    problem.add_term("sum", compiled, [[a[0], a[2]]], [[100.0]], row)
    assert problem.constraint_values(problem.x0) == pytest.approx([2 * 3 + 10 * 3 * 5 + 100 * 2 * 5])
    _, at = derivatives(problem, problem.x0, 0.0, np.array([2.0]))
    assert at["g"] == pytest.approx([1156.0])
    assert at["jacobian"] == pytest.approx(np.array([[3 + 500, 2 + 50, 30 + 200]]))
    assert at["hessian"] == pytest.approx(2.0 * np.array([[0, 1, 100], [1, 0, 10], [100, 10, 0]]))


def test_costs_add_up_and_leave_the_rows_alone() -> None:
    problem = Problem()
    a = problem.add_variables([1.0, 4.0], *FREE)
    compiled = kernel("test_square", 1, 2, square)
    problem.add_term("cost", compiled, a[:, None], [[2.0, 0.0], [3.0, 1.0]])
    problem.add_term("cost", compiled, a[:1, None], [[5.0, 3.0]])
    _, at = derivatives(problem, problem.x0, 0.5, np.zeros(0))
    assert at["f"] == pytest.approx(2.0 + 3.0 * 9.0 + 5.0 * 4.0)
    assert at["gradient"] == pytest.approx([4.0 - 20.0, 18.0])
    assert at["hessian"] == pytest.approx(0.5 * np.diag([4.0 + 10.0, 6.0]))
    assert at["g"].shape == (0,)


def test_variables_with_equal_bounds_are_constants_at_their_bound() -> None:
    problem = Problem()
    a = problem.add_variables([9.0, 3.0, 5.0], [2.0, -np.inf, -np.inf], [2.0, np.inf, np.inf])
    row = problem.add_rows("sum", 0.0, 0.0, (2, 1), "m", ["first", "second"])
    compiled = kernel("test_product", 2, 1, product)
    problem.add_term("sum", compiled, [[a[0], a[1]], [a[1], a[2]]], [[1.0], [1.0]], row)
    built, at = derivatives(problem, np.array([3.0, 5.0]), 0.0, np.array([1.0, 1.0]))
    assert built.free.tolist() == [1, 2]
    assert built.expand(problem, np.array([7.0, 8.0])).tolist() == [2.0, 7.0, 8.0]
    assert at["g"] == pytest.approx([2 * 3, 3 * 5]), "the bound counts, not the guess of 9"
    assert at["jacobian"] == pytest.approx(np.array([[2.0, 0.0], [5.0, 3.0]]))
    assert at["hessian"] == pytest.approx(np.array([[0.0, 1.0], [1.0, 0.0]]))


def test_one_variable_in_two_places_of_an_instance_is_differentiated_as_one() -> None:
    problem = Problem()
    a = problem.add_variables([2.0, 3.0], *FREE)
    rows = problem.add_rows("cross", 0.0, 0.0, (2, 2), "m", ["same", "swapped"])
    problem.add_term("cross", kernel("test_cross", 2, 0, cross), [[a[0], a[0]], [a[1], a[0]]], np.zeros(0), rows)
    lam = np.array([1.0, 10.0, 100.0, 1000.0])
    _, at = derivatives(problem, problem.x0, 0.0, lam)
    x, y = 2.0, 3.0  # rows: x² + x³, sin x, y x + x³, sin y
    assert at["g"] == pytest.approx([x**2 + x**3, np.sin(x), x * y + x**3, np.sin(y)])
    expected = [[2 * x + 3 * x**2, 0], [np.cos(x), 0], [y + 3 * x**2, x], [0, np.cos(y)]]
    assert at["jacobian"] == pytest.approx(np.array(expected))
    xx = 2 + 6 * x - 10 * np.sin(x) + 100 * 6 * x
    assert at["hessian"] == pytest.approx(np.array([[xx, 100.0], [100.0, -1000 * np.sin(y)]]))


def test_violations_name_the_worst_row_of_each_family() -> None:
    problem = Problem()
    a = problem.add_variables([2.0, 3.0], -1.0, [10.0, 2.5])
    rows = problem.add_rows("products", [[-1.0], [5.0]], [[1.0], [np.inf]], (2, 1), "m²", ["square", "mixed"])
    compiled = kernel("test_product", 2, 1, product)
    problem.add_term("products", compiled, [[a[0], a[0]], [a[0], a[1]]], [[1.0], [-1.0]], rows)
    worst = problem.violations(problem.x0)
    assert worst["products"] == (pytest.approx(5.0 + 6.0), "mixed", "m²")
    assert worst["bounds"] == (pytest.approx(0.5), 1, "")


def test_ipopt_finds_the_nearest_point_of_a_circle() -> None:
    problem = Problem()
    a = problem.add_variables([1.0, 0.1], *FREE)
    row = problem.add_rows("circle", 4.0, 4.0, (1, 1), "m²", ["radius"])
    compiled = kernel("test_product", 2, 1, product)
    problem.add_term("circle", compiled, [[a[0], a[0]], [a[1], a[1]]], [[1.0], [1.0]], np.vstack([row, row]))
    problem.add_term("near", kernel("test_square", 1, 2, square), a[:, None], [[1.0, 3.0], [1.0, 4.0]])
    solution = Ipopt().solve(problem)
    assert solution.solved
    assert solution.x == pytest.approx([1.2, 1.6], abs=1e-6)
    assert solution.cost == pytest.approx(9.0, abs=1e-6)


def test_ipopt_says_which_family_resists() -> None:
    problem = Problem()
    a = problem.add_variables([1.0], *FREE)
    row = problem.add_rows("square", -np.inf, -1.0, (1, 1), "m²", ["everywhere"])
    problem.add_term("square", kernel("test_product", 2, 1, product), [[a[0], a[0]]], [[1.0]], row)
    solution = Ipopt(max_iterations=30).solve(problem)
    assert not solution.solved
    assert solution.worst["square"][1:] == ("everywhere", "m²")
    assert solution.residual >= 1.0
