"""Gaits that carry a load: it counts in the plan, and the plan walks with it."""

from __future__ import annotations

import numpy as np
import pytest

import gaitforge as gf
from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.zmp import zero_moment_point
from gaitforge.robot.model import RobotModel
from tests.motion.motion_kit import PATIENT, TRIPOD

LOAD = gf.Load(1.0, (0.12, 0.03, 0.1))


@pytest.fixture(scope="module")
def laden(hexapod: RobotModel) -> MotionPlan:
    return gf.plan_gait(hexapod, TRIPOD, loads=[LOAD], samples_per_column=2, options=PATIENT)


def test_the_load_is_in_the_plan_and_in_its_centre_of_mass(hexapod: RobotModel, laden: MotionPlan) -> None:
    assert laden.loads == (LOAD,)
    pose, q = laden.base_poses[3], laden.joint_positions[:, 3]
    at = (hexapod.link_pose(hexapod.base_link, pose, q) @ np.append(LOAD.point, 1.0))[:3]
    both = hexapod.mass * hexapod.center_of_mass(pose, q) + LOAD.mass * at
    assert laden.com[3] == pytest.approx(both / (hexapod.mass + LOAD.mass), abs=1e-6)


def test_the_body_makes_room_for_the_load(tripod: MotionPlan, laden: MotionPlan) -> None:
    """The load sits 12 cm ahead and weighs a sixth of the robot: the body goes back against the feet, not the mass."""
    ahead = [float((p.com[:-1, 0] - p.base_poses[:-1, 0]).mean()) for p in (tripod, laden)]
    assert ahead[1] - ahead[0] > 0.01
    under = [float((p.com[:-1, 0] - p.feet[:-1, :, 0].mean(axis=1)).mean()) for p in (tripod, laden)]
    assert abs(under[1] - under[0]) < ahead[1] - ahead[0]


def test_the_zero_moment_point_is_that_of_the_laden_robot(hexapod: RobotModel, laden: MotionPlan) -> None:
    points = zero_moment_point(hexapod, laden)
    assert points.margin.min() > 0.0
    k = len(points.times) // 2
    pose, q = laden.base_spline(points.times[k]), laden.joint_spline(points.times[k])
    assert points.com[k] == pytest.approx(hexapod.carrying(LOAD).center_of_mass(pose, q), abs=1e-9)


def test_a_robot_that_carries_already_keeps_what_it_carries(hexapod: RobotModel, laden: MotionPlan) -> None:
    again = gf.plan_gait(hexapod.carrying(LOAD), TRIPOD, samples_per_column=2, options=PATIENT)
    assert np.array_equal(again.joint_positions, laden.joint_positions)


def test_stands_carry_what_their_gait_carries(hexapod: RobotModel, laden: MotionPlan) -> None:
    assert gf.plan_start(hexapod, laden, options=PATIENT).loads == (LOAD,)


def test_it_walks_with_its_load_in_simulation(hexapod: RobotModel, laden: MotionPlan) -> None:
    verdict = gf.verify(hexapod, [(laden, 2)])
    assert verdict.passed, verdict.failed
    weight = verdict.trace.normal_force.sum(axis=1).mean() / 9.81
    assert weight == pytest.approx(hexapod.mass + LOAD.mass, rel=0.01)
