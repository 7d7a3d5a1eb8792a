"""No plan: the cause is named correctly, with limb, time and amount, and the advice holds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import gaitforge as gf
from gaitforge.errors import UnsolvedError
from gaitforge.motion.problem import Problem, kernel
from gaitforge.motion.solvers.structured import Structured
from gaitforge.robot.model import RobotModel
from tests.motion.motion_kit import TRIPOD

BRIEF = gf.MotionOptions(solver=Structured(fallback=None))
TOO_FAST = {"rolling", "kinematics", "joint_speed"}
"""Families that resist when a foot cannot keep up with the ground, or not come back in time."""


def refused(robot: RobotModel, **asked: object) -> UnsolvedError:
    with pytest.raises(UnsolvedError) as caught:
        gf.plan_gait(robot, TRIPOD, options=BRIEF, **asked)  # type: ignore[arg-type]
    return caught.value


def test_rows_that_clash_are_found_with_the_amount_that_is_missing() -> None:
    """x ≥ 3 by one row, x ≤ 1 by another that is dearer, y = 5 by a third that is in nobody's way."""
    problem = Problem()
    x = problem.add_variables([0.0, 0.0], -10.0, 10.0)
    lower = problem.add_rows("at_least", 3.0, np.inf, (1, 1), "rad", [("L1", 4)])
    upper = problem.add_rows("at_most", -np.inf, 1.0, (1, 1), "m", [("R2", 7)])
    equal = problem.add_rows("equal", 5.0, 5.0, (1, 1), "m", [("R3", 0)])
    one = kernel("explained_one", 1, 0, lambda v, p: v[0])
    for row, variable in ((lower, x[0]), (upper, x[0]), (equal, x[1])):
        problem.add_term("row", one, [[variable]], np.zeros(0), row)
    found = Structured().nearest(problem).violations or ()
    assert [(v.family, v.label, v.unit) for v in found] == [("at_least", ("L1", 4), "rad")]
    assert found[0].amount == pytest.approx(2.0, abs=1e-2)


def test_too_fast_is_said_of_feet_that_cannot_keep_up_and_the_advised_speed_has_a_plan(hexapod: RobotModel) -> None:
    explain = refused(hexapod, speed=0.4).explain
    assert set(explain["families"]) & TOO_FAST
    assert explain["limbs"]
    advised = [p for p in explain["probed"] if p["has_a_plan"] and "m/s" in p["what"]]
    assert advised
    assert advised[0]["what"] in explain["advice"]
    speed = float(advised[0]["what"].split(" m/s")[0])
    assert gf.plan_gait(hexapod, TRIPOD, speed=speed, options=BRIEF).speed == pytest.approx(speed, rel=1e-6)


def test_steps_too_high_for_the_time_are_said_of_joint_speeds(hexapod: RobotModel) -> None:
    explain = refused(hexapod, step_height=0.3).explain
    assert explain["families"][0] in ("joint_speed", "kinematics")
    first = explain["causes"][0]
    assert first["by"] > 0.0
    assert 0.0 <= first["time_s"] <= 2.0


def test_turning_too_fast_is_said_of_the_feet(hexapod: RobotModel) -> None:
    explain = refused(hexapod, speed=0.05, yaw_rate=1.5).explain
    assert set(explain["families"]) & TOO_FAST
    assert any("rad/s" in p["what"] for p in explain["probed"])


def test_a_centre_of_pressure_that_no_pattern_holds_is_said_of_balance(hexapod: RobotModel) -> None:
    """Two feet on one side hold the robot for half of the cycle."""
    rows = {n: "111111111111" for n in hexapod.limb_names}
    rows |= {"R1": "111111000000", "R2": "111111000000", "R3": "111111000000"}
    pattern = gf.FootfallPattern.from_rows(rows)
    with pytest.raises(UnsolvedError) as caught:
        gf.plan_gait(hexapod, pattern, options=BRIEF)
    explain = caught.value.explain
    cause = next(c for c in explain["causes"] if c["family"] == "balance")
    assert set(cause["limb"].split("+")) <= {"L1", "L2", "L3"}
    assert cause["by"] > 0.01
    assert "centre of pressure" in cause["text"]
    assert 1.0 <= cause["time_s"] <= 2.0  # while the right feet are in the air
    assert not any(p["has_a_plan"] for p in explain["probed"])


def test_every_cause_stands_in_the_message_and_goes_into_json(hexapod: RobotModel) -> None:
    error = refused(hexapod, speed=0.4)
    assert error.explain["text"] in str(error)
    for cause in error.explain["causes"]:
        assert set(cause) == {"family", "limb", "sample", "time_s", "by", "unit", "text"}
        assert cause["limb"] == "" or set(cause["limb"].split("+")) <= set(hexapod.limb_names)


def test_nothing_is_probed_when_no_explanation_is_asked_for(hexapod: RobotModel) -> None:
    with pytest.raises(UnsolvedError) as caught:
        gf.plan_gait(hexapod, TRIPOD, speed=0.4, options=replace(BRIEF, explain=False))
    assert caught.value.explain["causes"]
    assert "probed" not in caught.value.explain
