"""Shapes that overlap where the robot stands, as thigh and trunk do in many files, do not throw it about."""

from __future__ import annotations

import pytest

import gaitforge as gf
from gaitforge.motion.bodies import housings
from gaitforge.task.scene import Scene
from gaitforge.verify.mujoco import MujocoSimulator
from gaitforge.verify.mujoco.world import build_world as in_mujoco
from gaitforge.verify.pybullet.client import direct_client
from gaitforge.verify.pybullet.world import build_world as in_pybullet
from tests.wheels import example

ANYMAL = "anymal_b_simple_description/robots/anymal.urdf"
THIGHS = {("base", "LF_THIGH"), ("base", "LH_THIGH"), ("base", "RF_THIGH"), ("base", "RH_THIGH")}


def test_a_robot_with_its_thighs_drawn_into_the_trunk_walks_in_both_and_the_verdict_says_what_it_ignored() -> None:
    robot = gf.load_robot(example(ANYMAL))
    gait = gf.plan_gait(robot, gf.synthesize_gait_pattern(robot))
    verdict = gf.verify(robot, [(gait, 2)], simulator="both")
    assert set(verdict.ignored_contacts) == {"pybullet", "mujoco"}
    for pairs in verdict.ignored_contacts.values():
        assert {tuple(pair) for pair in pairs} >= THIGHS
    judged = {"fallen", "speed", "heading", "tilt", "unplanned_contact", "static_margin"}
    assert [c for c in verdict.failed if c.name in judged] == []


def test_hips_that_are_drawn_into_each_other_leave_the_planner_free() -> None:
    robot = gf.load_robot(example(ANYMAL))
    assert {(a.name, b.name) for a, b in housings(robot)} == {("LF_HIP", "RF_HIP"), ("LH_HIP", "RH_HIP")}
    gait = gf.plan_gait(robot, gf.synthesize_gait_pattern(robot))
    assert gait.report.details["gap_m"] > 0.0


@pytest.mark.parametrize("name", ["hexapod", "dodecapod", "quadruped"])
def test_no_shapes_of_the_own_robots_overlap(name: str) -> None:
    robot = gf.load_robot(name)
    with direct_client("overlaps") as (p, number):
        assert in_pybullet(p, number, robot, Scene(), 1.0).overlapping == ()
    assert in_mujoco(robot, Scene(), MujocoSimulator().physics()).overlapping == ()
    assert housings(robot) == frozenset()
