"""Cyclic gaits: periodic, with exactly the commanded travel, inside the joints' limits, the same every time."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import gaitforge as gf
from gaitforge.errors import InputError
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import Command, MotionPlan, carry
from gaitforge.motion.trajectory import planar_motion
from gaitforge.robot.model import RobotModel
from tests.motion.conftest import TUCKED
from tests.motion.motion_kit import PENTA, TRIPOD

REPOSITORY = Path(__file__).resolve().parents[2]


def test_shapes_and_times_are_those_of_the_pattern(gait: MotionPlan, robot_of) -> None:
    robot, samples = robot_of(gait), gait.pattern.columns * gait.samples_per_column + 1
    assert gait.kind == "gait"
    assert gait.joint_positions.shape == (len(robot.joint_names), samples)
    assert (gait.base_poses.shape, gait.com.shape) == ((samples, 6), (samples, 3))
    assert gait.feet.shape == (samples, len(robot.limbs), 3)
    assert gait.weights.shape == (samples, 2, len(robot.limbs))
    assert np.diff(gait.times) == pytest.approx(np.full(samples - 1, gait.duration / (samples - 1)))


def test_joints_and_their_velocities_are_periodic(gait: MotionPlan) -> None:
    assert (gait.joint_positions[:, -1] == gait.joint_positions[:, 0]).all()
    for derivative in (0, 1, 2):
        first, last = gait.joint_spline(0.0, derivative), gait.joint_spline(gait.duration, derivative)
        assert last == pytest.approx(first, abs=1e-9)
    assert gait(gait.duration + 0.3) == pytest.approx(gait(0.3), abs=1e-9)


def test_the_spline_goes_through_the_samples(plan: MotionPlan) -> None:
    assert pytest.approx(plan.joint_positions, abs=1e-12) == plan(plan.times).T
    assert plan.base_spline(plan.times) == pytest.approx(plan.base_poses, abs=1e-9)


def test_height_roll_and_pitch_of_the_body_are_periodic_and_its_velocity_goes_on(gait: MotionPlan) -> None:
    assert gait.base_poses[-1, 2:5] == pytest.approx(gait.base_poses[0, 2:5], abs=1e-9)
    yaw = gait.base_poses[-1, 5] - gait.base_poses[0, 5]
    turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    first, last = gait.base_spline(0.0, 1), gait.base_spline(gait.duration, 1)
    assert last[:2] == pytest.approx(turn @ first[:2], abs=1e-6)
    assert last[2:] == pytest.approx(first[2:], abs=1e-6)


def test_straight_and_sideways_gaits_travel_exactly_as_commanded(
    tripod: MotionPlan, sideways: MotionPlan, wave: MotionPlan, quadruped: RobotModel
) -> None:
    assert tripod.base_poses[-1] - tripod.base_poses[0] == pytest.approx([0.128, 0, 0, 0, 0, 0], abs=1e-9)
    assert sideways.base_poses[-1] - sideways.base_poses[0] == pytest.approx([0, 0.128, 0, 0, 0, 0], abs=1e-9)
    way = quadruped.nominal.speed * quadruped.nominal.duration
    assert wave.base_poses[-1] - wave.base_poses[0] == pytest.approx([way, 0, 0, 0, 0, 0], abs=1e-9)
    assert tripod.speed == pytest.approx(0.064)


def test_a_turning_gait_goes_around_the_circle_of_its_command(turning: MotionPlan) -> None:
    command = turning.command
    assert command == Command(0.05, 0.3, 0.15)
    radius, yaw = 0.05 / 0.15, 0.15 * turning.duration
    centre = radius * np.array([-np.sin(0.3), np.cos(0.3)])
    spoke = turning.base_poses[0, :2] - centre
    turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    assert turning.base_poses[-1, :2] == pytest.approx(centre + turn @ spoke, abs=1e-9)
    assert turning.base_poses[-1, 5] - turning.base_poses[0, 5] == pytest.approx(yaw, abs=1e-12)


def test_carrying_a_cycle_forth_and_back_is_nothing(turning: MotionPlan) -> None:
    poses, first, last = turning.base_poses, turning.base_poses[0], turning.base_poses[-1]
    assert carry(poses[:1], first, last, 1)[0] == pytest.approx(last)
    assert carry(carry(poses, first, last, 3), first, last, -3) == pytest.approx(poses, abs=1e-12)


def test_a_constant_twist_integrated_in_small_steps_is_the_planar_motion() -> None:
    for command in (Command(0.3, 0.7, 0.9), Command(0.3, 0.7, 0.0), Command(0.0, 0.0, -1.2)):
        x = y = yaw = 0.0
        steps = 20000
        for _ in range(steps):
            middle = yaw + command.yaw_rate / steps  # half of a step of 2 s
            x += command.speed * np.cos(middle + command.heading) * 2.0 / steps
            y += command.speed * np.sin(middle + command.heading) * 2.0 / steps
            yaw += command.yaw_rate * 2.0 / steps
        assert planar_motion(command, 2.0) == pytest.approx([x, y, yaw], abs=1e-8)


def test_the_spline_keeps_joint_limits_and_speeds(plan: MotionPlan, robot_of) -> None:
    robot, times = robot_of(plan), np.linspace(0.0, plan.duration, 2001)
    options = MotionOptions()
    joints, speeds = plan(times), np.abs(plan.joint_spline(times, 1))
    assert (joints > robot.lower).all()
    assert (joints < robot.upper).all()
    assert (speeds.max(axis=0) / robot.velocity).max() < options.speed_share + 0.02
    assert plan.base_poses[:, 3:5] == pytest.approx(np.zeros((len(plan.times), 2)), abs=options.tilt_limit)
    assert plan.base_poses[:, 2] == pytest.approx(robot.nominal.body_height, abs=options.height_range + 1e-6)


def test_limbs_that_do_not_walk_keep_their_posture(penta: MotionPlan, hexapod: RobotModel) -> None:
    rows = hexapod.joint_indices(hexapod.limb("R1"))
    assert (penta.joint_positions[rows].T == TUCKED).all()
    tools = [hexapod.joint_names.index(j) for limb in hexapod.limbs for j in limb.tool_joints]
    assert (hexapod.nominal.posture[tools] == penta.joint_positions[tools].T).all()


def test_a_failed_limb_stays_where_it_failed(hexapod: RobotModel) -> None:
    where = np.array([0.3, 0.5, 0.4])
    options = MotionOptions(stability_shares=(0.3,))
    plan = gf.plan_gait(
        hexapod, PENTA, speed=0.03, roles={"R1": gf.Failed()}, postures={"R1": where}, samples_per_column=1,
        options=options,
    )  # fmt: skip
    assert (where == plan.joint_positions[hexapod.joint_indices(hexapod.limb("R1"))].T).all()
    assert plan.roles == {"R1": gf.Failed()}


def test_a_limb_that_does_not_exist_is_refused_with_the_names_that_do(hexapod: RobotModel) -> None:
    with pytest.raises(InputError) as refusal:
        gf.plan_gait(hexapod, PENTA, roles={"R7": gf.Held()})
    (problem,) = refusal.value.problems
    assert problem.found == "'R7'"
    assert "L1, L2, L3, R1, R2, R3" in problem.expected


def test_the_report_says_what_refinement_did(wave: MotionPlan) -> None:
    """Short swings ring: the quadruped's wave asks for a finer grid, and says what it cost."""
    details = wave.report.details
    assert wave.report.residual < 1e-5
    assert details["samples_per_column"] == wave.samples_per_column > 2
    assert details["refinements"] == len(details["refined"]) - 1 >= 1
    first, second = details["refined"][:2]
    assert (first["for"], second["for"]) == ([], ["ground"])
    assert second["rows"] > first["rows"] > 0
    assert sum(entry["iterations"] for entry in details["refined"]) == wave.report.iterations
    assert details["penetration_m"] <= MotionOptions().ground_tolerance
    assert wave.relaxed == ()


def test_a_tripod_leaves_the_ground_slowly_and_needs_no_finer_grid(tripod: MotionPlan) -> None:
    assert tripod.samples_per_column == 2
    assert tripod.report.details["refinements"] == 0
    assert tripod.report.details["penetration_m"] <= MotionOptions().ground_tolerance
    assert tripod.report.details["zmp_margin_m"] > 0.0
    assert tripod.report.details["cop_margin_m"] > 0.0


def test_the_same_gait_is_found_again_in_another_process(hexapod: RobotModel) -> None:
    program = (
        "import sys, numpy as np, gaitforge as gf\n"
        "from tests.motion.motion_kit import TRIPOD\n"
        "plan = gf.plan_gait(gf.load_robot('hexapod'), TRIPOD, speed=0.05, samples_per_column=1)\n"
        "np.savez(sys.stdout.buffer, P=plan.joint_positions, base=plan.base_poses)\n"
    )
    environment = {**os.environ, "PYTHONPATH": str(REPOSITORY)}
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True, env=environment)
    from io import BytesIO

    there = np.load(BytesIO(done.stdout))
    here = gf.plan_gait(hexapod, TRIPOD, speed=0.05, samples_per_column=1)
    assert here.joint_positions == pytest.approx(there["P"], abs=1e-12)
    assert here.base_poses == pytest.approx(there["base"], abs=1e-12)
