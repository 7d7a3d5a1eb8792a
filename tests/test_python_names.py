"""What the command line does, a notebook does: the public names, end to end on the hexapod."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import gaitforge as gf

FIVE = ["L1", "L2", "L3", "R2", "R3"]


@pytest.fixture(scope="module")
def robot() -> gf.RobotModel:
    return gf.load_robot("hexapod")


@pytest.fixture(scope="module")
def gait_a(robot: gf.RobotModel) -> gf.MotionPlan:
    pattern = gf.synthesize_gait_pattern(robot, columns=12)
    return gf.plan_gait(
        robot, pattern, speed=0.064, heading=0.0, yaw_rate=0.0, duration=2.0, samples_per_column=2, name="six"
    )


@pytest.fixture(scope="module")
def gait_b(robot: gf.RobotModel) -> gf.MotionPlan:
    pattern = gf.synthesize_gait_pattern(robot, locomotive=FIVE, columns=12)
    return gf.plan_gait(
        robot, pattern, speed=0.064, duration=2.0, samples_per_column=4, roles={"R1": gf.Held((0.0, 0.7, 0.2))},
        name="five",
    )  # fmt: skip


@pytest.fixture(scope="module")
def move(robot: gf.RobotModel, gait_a: gf.MotionPlan, gait_b: gf.MotionPlan) -> gf.MotionPlan:
    pattern = gf.synthesize_transition_pattern(robot, gait_a, gait_b, columns=11)
    return gf.plan_transition(robot, gait_a, gait_b, pattern=pattern)


@pytest.fixture(scope="module")
def verdict(robot: gf.RobotModel, gait_a: gf.MotionPlan, move: gf.MotionPlan, gait_b: gf.MotionPlan) -> gf.Verdict:
    pipe = {"name": "pipe", "kind": "pipe", "xyz": (2.5, 0.0, 0.3)}
    return gf.verify(robot, [(gait_a, 2), (move, 1), (gait_b, 2)], scene=[pipe], simulator="pybullet")


def test_a_robot_tells_its_limbs_joints_and_feet(robot: gf.RobotModel) -> None:
    assert [limb.name for limb in robot.limbs] == ["L1", "L2", "L3", "R1", "R2", "R3"]
    limb = robot.limb("L2")
    assert (limb.name, limb.side, len(limb.joints)) == ("L2", "left", 3)
    assert limb.foot.link in limb.links
    assert set(limb.joints) <= set(robot.joint_names)


def test_a_pattern_is_c_with_its_rows_named(robot: gf.RobotModel, gait_b: gf.MotionPlan) -> None:
    pattern = gait_b.pattern
    assert pattern.contact.dtype == bool
    assert pattern.contact.shape == (6, 12)
    assert pattern.limbs == robot.limb_names
    assert pattern.locomotive == tuple(FIVE)


def test_a_gait_is_p_with_times_base_poses_and_its_spline(robot: gf.RobotModel, gait_a: gf.MotionPlan) -> None:
    assert gait_a.joint_positions.shape == (len(robot.joint_names), 2 * 12 + 1)
    assert gait_a.base_poses.shape == (25, 6)
    assert gait_a.times[[0, -1]].tolist() == [0.0, 2.0]
    assert gait_a(gait_a.times[7]) == pytest.approx(gait_a.joint_positions[:, 7])
    assert gait_a.base_poses[-1, 0] - gait_a.base_poses[0, 0] == pytest.approx(0.128)


def test_a_transition_meets_both_gaits(gait_a: gf.MotionPlan, move: gf.MotionPlan, gait_b: gf.MotionPlan) -> None:
    assert move(0.0) == pytest.approx(gait_a(2.0), abs=1e-6)
    assert move(move.duration) == pytest.approx(gait_b(0.0), abs=1e-6)


def test_the_baseline_is_the_same_name_with_another_method(
    robot: gf.RobotModel, gait_a: gf.MotionPlan, gait_b: gf.MotionPlan
) -> None:
    blend = gf.plan_transition(robot, gait_a, gait_b, method="interpolate")
    assert blend(1.0) == pytest.approx(0.5 * (gait_a(1.0) + gait_b(1.0)), abs=1e-9)


def test_the_simulator_judges_the_run(verdict: gf.Verdict) -> None:
    failed = [c for c in verdict.checks if not c.passed]
    assert verdict.passed, failed
    assert {c.segment for c in verdict.checks} >= {"start", "six", "transition", "five", "stop"}
    assert len(verdict.trace.times) > 1000


def test_the_log_of_a_verdict_can_be_read_back(robot: gf.RobotModel, verdict: gf.Verdict, tmp_path: Path) -> None:
    from mcap.reader import make_reader

    gf.write_log(tmp_path / "run.mcap", robot, verdict)
    with (tmp_path / "run.mcap").open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    assert summary.statistics.message_count > 1000
    assert "/tf" in {channel.topic for channel in summary.channels.values()}


def test_what_cannot_be_is_told_by_the_errors_module(robot: gf.RobotModel, gait_a: gf.MotionPlan) -> None:
    with pytest.raises(gf.errors.InfeasibleFootfall) as refusal:
        gf.synthesize_gait_pattern(robot, locomotive=["L1", "L2", "R3"])
    assert refusal.value.explain["families"]
    with pytest.raises(gf.errors.InputError, match="R9"):
        gf.plan_gait(robot, gait_a.pattern, roles={"R9": gf.Failed()})
    with pytest.raises(gf.errors.InputError, match="unicycle"):
        gf.load_robot("unicycle")


def test_a_tool_role_is_a_look_at_with_a_frame() -> None:
    tool = gf.Tool(look_at=[2.5, 0, 0.3])
    assert (tool.look_at, tool.frame) == ((2.5, 0.0, 0.3), "world")
    with pytest.raises(ValueError, match="three coordinates"):
        gf.Tool(look_at=[2.5, 0])


def test_every_public_name_is_there_and_nothing_heavy_is_loaded_for_it() -> None:
    for name in gf.__all__:
        assert getattr(gf, name) is not None
    with pytest.raises(AttributeError, match="nothing"):
        gf.nothing  # noqa: B018
    program = (
        "import sys, gaitforge as gf; dir(gf); gf.plan_gait, gf.load_robot, gf.verify, gf.Tool;"
        "heavy = {'casadi', 'pinocchio', 'pybullet', 'ortools', 'matplotlib', 'mcap'};"
        "print(sorted(heavy & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
