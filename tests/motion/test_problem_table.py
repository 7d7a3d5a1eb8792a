"""The problem table counts what the problem is made of, and what has a say at the solution."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import gaitforge as gf
from gaitforge.motion.plan import Command, MotionPlan
from gaitforge.motion.problem import Problem, kernel
from gaitforge.motion.report import TableRow
from gaitforge.motion.table import problem_table
from gaitforge.report.summary import segment_entry
from gaitforge.report.text import problem_text
from gaitforge.robot.model import RobotModel
from tests.motion.motion_kit import PATIENT, TRIPOD, gait_segment, instance


def product(v: Any, p: Any) -> Any:
    return v[0] * v[1]


def square(v: Any, p: Any) -> Any:
    return 3.0 * v[0] ** 2


def test_a_table_small_enough_to_count_by_hand() -> None:
    problem = Problem()
    a = problem.add_variables(np.ones((4, 2)), [0.0, -np.inf], np.inf)
    rows = problem.add_rows("pairs", -np.inf, 1.0, (4, 1), "", range(4))
    problem.add_term("pairs", kernel("table_product", 2, 0, product), a, np.zeros(0), rows)
    problem.add_term("level", kernel("table_square", 1, 0, square), a[:, :1], np.zeros(0))
    x = np.array([1.0, 1.0, 0.5, 0.5, 0.0, 2.0, 1.0, 0.5])
    assert problem_table(problem, x) == (
        TableRow("pairs", "constraint", 4, 8, 4, 0.25, None, "at samples"),
        TableRow("level", "cost", 0, 4, 4, None, pytest.approx(3 * (1 + 0.25 + 1)), "at samples"),  # type: ignore[arg-type]
        TableRow("bounds", "bound", 4, 4, 4, 0.25, None, "at samples: joints, feet, body, weights"),
    )


def test_rows_and_costs_of_the_table_are_those_of_the_problem(hexapod: RobotModel) -> None:
    case = instance(gait_segment(hexapod, TRIPOD, Command(0.06)))
    table = problem_table(case.problem, case.x)
    assert sum(row.rows for row in table if row.kind == "constraint") == case.problem.row_count
    cost = sum(
        float(t.kernel.value(case.x[v], p))
        for t in case.problem.terms
        if t.rows is None
        for v, p in zip(t.variables, t.parameters, strict=True)
    )
    assert sum(row.cost or 0.0 for row in table) == pytest.approx(cost, rel=1e-9)


@pytest.fixture(scope="module")
def tabled(hexapod: RobotModel) -> MotionPlan:
    return gf.plan_gait(hexapod, TRIPOD, samples_per_column=2, options=replace(PATIENT, table=True))


def test_a_plan_has_its_table_when_asked(tabled: MotionPlan, tripod: MotionPlan) -> None:
    assert tripod.report.table == ()
    rows = {row.family: row for row in tabled.report.table}
    assert rows["balance"].active == rows["kinematics"].active == 1.0
    assert rows["balance"].enforced != rows["kinematics"].enforced
    assert sum(row.cost or 0.0 for row in tabled.report.table) == pytest.approx(tabled.report.cost, rel=1e-6)


def test_the_table_stands_in_the_summary_and_in_print(tabled: MotionPlan, tripod: MotionPlan) -> None:
    entry = segment_entry(tabled)
    assert [row["family"] for row in entry["problem"]] == [row.family for row in tabled.report.table]
    assert "problem" not in segment_entry(tripod)
    printed = problem_text(entry["problem"]).splitlines()
    assert len(printed) == 2 + len(entry["problem"])
    assert printed[0].split()[:3] == ["family", "kind", "rows"]
