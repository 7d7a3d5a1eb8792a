"""Equation (3), the baseline, against the formula as it is printed."""

from __future__ import annotations

import numpy as np
import pytest

import gaitforge as gf
from gaitforge.motion.plan import MotionPlan
from gaitforge.robot.model import RobotModel
from tests.motion.motion_kit import TRIPOD


@pytest.fixture(scope="module")
def slow(hexapod: RobotModel) -> MotionPlan:
    """A gait of another duration."""
    return gf.plan_gait(hexapod, TRIPOD, speed=0.03, duration=3.0, samples_per_column=1)


def test_gaits_of_one_duration_are_blended_by_time(hexapod: RobotModel, tripod: MotionPlan, penta: MotionPlan) -> None:
    plan = gf.plan_transition(hexapod, tripod, penta, method="interpolate")
    duration = tripod.duration
    assert plan.duration == pytest.approx(duration)
    for t, q in zip(plan.times, plan.joint_positions.T, strict=True):
        expected = tripod(t) * (1 - t / duration) + penta(t) * t / duration  # equation (3)
        assert q == pytest.approx(expected, abs=1e-12)


def test_gaits_of_two_durations_are_blended_by_phase_over_their_mean(
    hexapod: RobotModel, tripod: MotionPlan, slow: MotionPlan
) -> None:
    plan = gf.plan_transition(hexapod, tripod, slow, method="interpolate")
    assert plan.duration == pytest.approx(2.5)
    for t, q in zip(plan.times, plan.joint_positions.T, strict=True):
        s = t / 2.5
        assert q == pytest.approx((1 - s) * tripod(2.0 * s) + s * slow(3.0 * s), abs=1e-9)


def test_the_spline_is_clamped_to_the_derivative_of_the_formula(
    hexapod: RobotModel, tripod: MotionPlan, slow: MotionPlan
) -> None:
    plan, h = gf.plan_transition(hexapod, tripod, slow, method="interpolate"), 1e-6

    def formula(t: float) -> np.ndarray:
        return (1 - t / 2.5) * tripod(2.0 * t / 2.5) + t / 2.5 * slow(3.0 * t / 2.5)

    for end, t in enumerate((0.0, plan.duration)):
        slope = (formula(t + h) - formula(t - h)) / (2 * h)
        assert plan.joint_velocity_ends[end] == pytest.approx(slope, abs=1e-6)
        assert plan.joint_spline(t, 1) == pytest.approx(slope, abs=1e-6)


def test_the_pattern_is_of_one_gait_and_then_of_the_other(
    hexapod: RobotModel, tripod: MotionPlan, penta: MotionPlan
) -> None:
    plan = gf.plan_transition(hexapod, tripod, penta, method="interpolate")
    assert (plan.pattern.contact[:, :6] == tripod.pattern.contact[:, :6]).all()
    assert (plan.pattern.contact[:, 6:] == penta.pattern.contact[:, 6:]).all()
    assert (plan.pattern.source, plan.pattern.cyclic, plan.kind) == ("interpolated", False, "transition")


def test_the_body_goes_by_the_blend_of_both_velocities(
    hexapod: RobotModel, tripod: MotionPlan, slow: MotionPlan
) -> None:
    plan = gf.plan_transition(hexapod, tripod, slow, method="interpolate")
    for t in np.linspace(0.05, plan.duration - 0.05, 40):
        s = t / 2.5
        a, b = tripod.base_spline(2.0 * s, 1) * 2.0 / 2.5, slow.base_spline(3.0 * s, 1) * 3.0 / 2.5
        assert plan.base_spline(t, 1)[0] == pytest.approx((1 - s) * a[0] + s * b[0], abs=3e-3)  # two samples a column
    for k, s in enumerate(plan.times / 2.5):
        level = (1 - s) * tripod.base_spline(2.0 * s) + s * slow.base_spline(3.0 * s)
        assert plan.base_poses[k, 2:5] == pytest.approx(level[2:5], abs=1e-9)
    way = plan.base_poses[-1, 0] - plan.base_poses[0, 0]
    assert way == pytest.approx(0.5 * (0.128 + 0.09), abs=5e-3), "about half a cycle of each"


def test_between_turning_gaits_the_body_goes_on_turning(hexapod: RobotModel, turning: MotionPlan) -> None:
    """A gait blended with itself is that gait, circle and all."""
    plan = gf.plan_transition(hexapod, turning, turning, method="interpolate")
    assert plan.joint_positions == pytest.approx(turning.joint_positions, abs=1e-12)
    assert plan.base_poses == pytest.approx(turning.base_poses, abs=5e-4)
    assert plan.base_velocity_ends[1] == pytest.approx(turning.base_spline(turning.duration, 1), abs=1e-3)
