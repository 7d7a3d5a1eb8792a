"""Commands besides the velocity: where the body is, how high feet go, how limbs stand, how long a cycle takes."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

import gaitforge as gf
from gaitforge.errors import InfeasibleMotion, InputError, UnsolvedError
from gaitforge.motion.duration import LONGEST, RESOLUTION, SOLVES, load_of, shortest
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import Command, MotionPlan
from gaitforge.motion.stance import commanded_stance
from gaitforge.motion.transition import mean_command
from gaitforge.robot.model import RobotModel
from tests.motion.motion_kit import PATIENT, TRIPOD
from tests.robot.kit import write_robot


def gait(robot: RobotModel, **command: object) -> MotionPlan:
    return gf.plan_gait(robot, TRIPOD, samples_per_column=2, options=PATIENT, **command)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("command", "column", "goal"),
    [({"body_height": 0.16}, 2, 0.16), ({"roll": -0.08}, 3, -0.08), ({"pitch": 0.1}, 4, 0.1)],
)
def test_the_body_is_where_it_was_commanded_in_the_mean(
    hexapod: RobotModel, tripod: MotionPlan, command: dict[str, float], column: int, goal: float
) -> None:
    mean = gait(hexapod, **command).base_poses[:-1, column].mean()
    usual = tripod.base_poses[:-1, column].mean()
    nominal = hexapod.nominal.body_height if column == 2 else 0.0
    assert mean - usual == pytest.approx(goal - nominal, rel=0.1)


def test_feet_stay_in_place_when_the_body_is_lifted_or_tilted(any_robot: RobotModel) -> None:
    level = np.array([0.0, 0.0, any_robot.nominal.body_height, 0.0, 0.0, 0.0])
    before = any_robot.foot_positions(level, any_robot.nominal.posture)[:, :2]
    stance = commanded_stance(any_robot, Command(body_height=level[2] - 0.02, roll=0.03, pitch=-0.02))
    feet = any_robot.foot_positions([0.0, 0.0, *stance.body, 0.0], stance.joints)
    assert feet[:, :2] == pytest.approx(before, abs=1e-6)
    assert feet[:, 2] == pytest.approx([limb.foot.radius for limb in any_robot.limbs], abs=1e-6)


def test_nothing_commanded_is_the_nominal_stance(hexapod: RobotModel) -> None:
    stance = commanded_stance(hexapod, Command())
    assert np.array_equal(stance.joints, hexapod.nominal.posture)
    assert stance.body.tolist() == [hexapod.nominal.body_height, 0.0, 0.0]


def test_steps_are_as_high_as_commanded(hexapod: RobotModel) -> None:
    for height in (0.02, 0.05):
        plan = gait(hexapod, step_height=height)
        lift = plan.feet[:-1, :, 2].max(axis=0) - [limb.foot.radius for limb in hexapod.limbs]
        assert (lift >= height - 1e-6).all()
        assert (lift <= 1.3 * height).all()


def test_a_posture_is_stood_in_by_name_or_by_limb(tmp_path_factory: pytest.TempPathFactory) -> None:
    fanned = "  speed: 0.064                   # m/s\n"
    named = "  postures: {fanned: {L1: [0.3, 0, 0], R1: [-0.3, 0, 0]}}\n"
    path = write_robot(tmp_path_factory.mktemp("fanned"), "hexapod", (fanned, named + fanned))
    robot = gf.load_robot(path)
    by_name = commanded_stance(robot, Command(), "fanned")
    by_limb = commanded_stance(robot, Command(), {"L1": [0.3, 0.0, 0.0], "R1": [-0.3, 0.0, 0.0]})
    assert np.array_equal(by_name.joints, by_limb.joints)
    plan = gf.plan_gait(robot, TRIPOD, posture="fanned", samples_per_column=2, options=PATIENT)
    first = plan.joint_positions[robot.joint_indices(robot.limb("L1"))[0]]
    assert first.mean() == pytest.approx(0.3, abs=0.08)
    with pytest.raises(InputError, match="one of nominal, fanned"):
        commanded_stance(robot, Command(), "wide")
    with pytest.raises(InputError, match=r"posture\.L1"):
        commanded_stance(robot, Command(), {"L1": [0.0, 0.0, 2.0]})


def test_a_body_too_high_for_its_legs_is_refused_with_a_reason(hexapod: RobotModel) -> None:
    with pytest.raises(InfeasibleMotion, match=r"body height of 0\.6 m is impossible: limb L1 reaches") as caught:
        gait(hexapod, body_height=0.6)
    assert caught.value.explain["families"] == ["reach"]


def test_a_transition_takes_the_stance_from_one_gait_to_the_other(hexapod: RobotModel) -> None:
    low, high = gait(hexapod, body_height=0.12, name="low"), gait(hexapod, body_height=0.15, name="high")
    move = gf.plan_transition(hexapod, low, high, options=PATIENT)
    heights = move.base_poses[:, 2]
    assert heights[0] == pytest.approx(low.base_poses[0, 2])
    assert heights[-1] == pytest.approx(high.base_poses[0, 2])
    assert np.interp(0.5, np.linspace(0, 1, len(heights)), heights) == pytest.approx(0.135, abs=0.01)


def test_a_transition_steps_as_high_as_the_higher_gait() -> None:
    assert mean_command(Command(step_height=0.02), Command(step_height=0.05)).step_height == 0.05
    assert mean_command(Command(), Command()).step_height is None


def planned(seconds: float, shape: MotionPlan) -> MotionPlan:
    return replace(shape, times=np.linspace(0.0, seconds, len(shape.times)))


@pytest.mark.parametrize("needed", [0.7, 1.4, 2.0, 5.0])
def test_the_shortest_duration_is_bracketed_by_few_solves(tripod: MotionPlan, needed: float) -> None:
    """A plan whose speeds go as one over the duration, with a part that does not."""
    asked: list[float] = []

    def plan_at(seconds: float) -> MotionPlan:
        asked.append(seconds)
        return planned(seconds, tripod)

    plan = shortest(2.0, plan_at, lambda p: 0.3 + 0.7 * needed / p.duration)
    assert needed * (1 - 1e-9) <= plan.duration <= needed * (1 + RESOLUTION) ** 2
    assert len(asked) <= SOLVES + 3
    assert set(plan.report.details["durations_tried_s"]) == {f"{s:.3f}" for s in asked}


def test_no_duration_is_found_where_none_has_a_plan(tripod: MotionPlan) -> None:
    def plan_at(seconds: float) -> MotionPlan:
        raise UnsolvedError(f"nothing at {seconds:g}")

    with pytest.raises(UnsolvedError, match=f"nothing at {2.0 * LONGEST:g}"):
        shortest(2.0, plan_at, lambda p: 1.0)
    with pytest.raises(UnsolvedError, match="no duration up to 8 s"):
        shortest(2.0, partial(planned, shape=tripod), lambda p: 20.0 / p.duration)


def test_a_longer_cycle_is_not_looked_for_where_it_does_not_help(tripod: MotionPlan) -> None:
    """Torques stay what they are; the search ends at the second duration."""
    asked: list[float] = []

    def plan_at(seconds: float) -> MotionPlan:
        asked.append(seconds)
        return planned(seconds, tripod)

    with pytest.raises(UnsolvedError, match=r"no duration up to .* keeps joint speeds and torques") as caught:
        shortest(2.0, plan_at, lambda p: 1.3)
    assert len(asked) == 2
    assert "take load off" in caught.value.explain["advice"]


def test_a_duration_is_found_for_the_hexapod(hexapod: RobotModel, tripod: MotionPlan) -> None:
    options = replace(PATIENT, speed_share=0.7, effort_share=0.9)
    plan = gf.plan_gait(hexapod, TRIPOD, duration="auto", samples_per_column=2, options=options)
    assert plan.duration < tripod.duration
    assert load_of(options, plan) <= 1.0
    left = [float(s) for s, load in plan.report.details["durations_tried_s"].items() if load > 1.0]
    assert max(left) > 0.8 * plan.duration


def test_a_zero_moment_point_at_the_border_counts_as_overload(tripod: MotionPlan) -> None:
    details = {**tripod.report.details, "zmp_margin_m": 0.001}
    assert load_of(MotionOptions(), replace(tripod, report=replace(tripod.report, details=details))) == float("inf")
