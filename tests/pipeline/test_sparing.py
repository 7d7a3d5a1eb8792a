"""Plans that are more than the motors hold, made again with bounds on their efforts."""

from __future__ import annotations

from dataclasses import replace

import pytest

import gaitforge as gf
from gaitforge.motion.constraints.effort import Effort
from gaitforge.motion.strain import bounded, least_strain
from gaitforge.pipeline.search.sparing import spared
from gaitforge.pipeline.search.tries import Try, attempt, unexplained
from gaitforge.robot.model import RobotModel
from tests.motion.motion_kit import TRIPOD


def weaker(share: float) -> RobotModel:
    robot = gf.load_robot("hexapod")
    return replace(robot, effort=share * robot.effort)


def tripod_of(robot: RobotModel) -> Try:
    return Try("tripod", "gait", robot, (TRIPOD,), {"options": unexplained(None)})


def test_a_plan_that_motors_hold_is_left_as_it_is() -> None:
    one = tripod_of(weaker(1.0))
    result = attempt(one)
    assert spared(one, result) is result


def test_what_is_too_much_for_the_motors_is_made_again_with_bounds_that_they_hold() -> None:
    robot = weaker(0.35)
    one = tripod_of(robot)
    result = attempt(one)
    assert result.plan is not None
    assert least_strain(robot, result.plan) > 1.0
    found = spared(one, result)
    assert found.plan is not None
    assert least_strain(robot, found.plan) <= 1.0
    assert found.what == "tripod, at 1.2 of the motors' efforts"
    assert found.plan.report.details["effort_ratio"] < 1.25


def test_where_bounds_leave_no_plan_there_is_what_there_was() -> None:
    robot = weaker(0.1)
    one = tripod_of(robot)
    result = attempt(one)
    assert spared(one, result) is result


def test_a_try_without_a_plan_is_not_made_again(monkeypatch: pytest.MonkeyPatch) -> None:
    def never(*_: object) -> None:
        raise AssertionError

    monkeypatch.setattr("gaitforge.pipeline.search.sparing.attempt", never)
    one = tripod_of(weaker(1.0))
    result = replace(attempt(one), plan=None)
    assert spared(one, result) is result


def test_a_bound_that_was_asked_for_gives_way_to_a_smaller_one_alone() -> None:
    options = bounded(bounded(gf.MotionOptions(), 0.8), 1.2)
    assert [f.share for f in options.constraints if isinstance(f, Effort)] == [0.8]
    options = bounded(bounded(gf.MotionOptions(), 1.2), 1.0)
    assert [f.share for f in options.constraints if isinstance(f, Effort)] == [1.0]
