"""Limp limbs that are folded against the ground, and the stance from which they hang clear of it."""

from dataclasses import replace

import numpy as np
import pinocchio
import pytest

import gaitforge as gf
from gaitforge.errors import UnsolvedError
from gaitforge.footfall.given import stand_pattern
from gaitforge.motion.failure.fold import COLUMNS, Folded, backwards, plan_dip, plan_fold, plan_rise
from gaitforge.motion.failure.hanging import gravity_torques, hanging_joints, lowest_point
from gaitforge.motion.failure.raised import LIGHT_M, SPARE_M, hanging_height, raised, touches
from gaitforge.motion.plan import Command, MotionPlan
from gaitforge.motion.timeline_build import build_timeline
from gaitforge.robot.model import RobotModel
from gaitforge.task.scene import Scene
from gaitforge.verify.mujoco import MujocoSimulator
from gaitforge.verify.pybullet import PyBulletSimulator

FRICTION = 0.2


@pytest.fixture(scope="module")
def hexapod() -> RobotModel:
    return gf.load_robot("hexapod")


def standing(robot: RobotModel, limp: tuple[str, ...]) -> MotionPlan:
    """The robot stands in its nominal posture, limp limbs with the others."""
    joints, base = robot.nominal.posture, np.array([0.0, 0.0, robot.nominal.body_height, 0.0, 0.0, 0.0])
    roles = {n: gf.Failed("limp", tuple(joints[robot.joint_indices(robot.limb(n))])) for n in limp}
    n = 9
    return MotionPlan(
        name="stand", kind="stand", pattern=stand_pattern(robot, 4, free=limp), times=np.linspace(0.0, 0.5, n),
        joint_positions=np.tile(joints[:, None], n), base_poses=np.tile(base, (n, 1)),
        com=np.tile(robot.center_of_mass(base, joints), (n, 1)),
        feet=np.tile(robot.foot_positions(base, joints), (n, 1, 1)), weights=np.zeros((n, 2, len(robot.limbs))),
        command=Command(), roles=roles, joint_velocity_ends=np.zeros((2, len(joints))),
        base_velocity_ends=np.zeros((2, 6)),
    )  # fmt: skip


def fold(robot: RobotModel, *limbs: str) -> tuple[MotionPlan, Folded]:
    stand = standing(robot, limbs)
    return stand, plan_fold(robot, stand, stand.roles, limbs, FRICTION)


@pytest.fixture(scope="module")
def folded(hexapod: RobotModel) -> tuple[MotionPlan, Folded]:
    return fold(hexapod, "L2")


@pytest.mark.parametrize("name", ["L1", "R2"])
def test_gravity_turns_joints_by_the_torques_of_pinocchio(hexapod: RobotModel, name: str) -> None:
    limb, rows = hexapod.limb(name), hexapod.joint_indices(hexapod.limb(name))
    joints = hexapod.nominal.posture.copy()
    joints[rows] = [0.3, 0.4, -0.7]
    q = hexapod.configuration(np.zeros((1, 6)), joints[None])[0]
    torques = pinocchio.computeGeneralizedGravity(hexapod.pin, hexapod.pin_data, q)
    expected = [torques[hexapod.pin.joints[hexapod.pin.getJointId(n)].idx_v] for n in limb.joints]
    np.testing.assert_allclose(gravity_torques(hexapod, limb, joints[rows]), expected, atol=1e-6)


@pytest.mark.parametrize(
    ("name", "start"), [("L2", (0.1, 0.8, -0.5)), ("R1", (0.0, 1.3, -1.4)), ("L1", (0.2, 0.3, 0.2))]
)
def test_friction_holds_a_hanging_limb_where_gravity_no_longer_turns_it(
    hexapod: RobotModel, name: str, start: tuple[float, ...]
) -> None:
    """The conditions of dry friction: no joint is turned by more, those that have turned are held by all of it."""
    limb = hexapod.limb(name)
    found = hanging_joints(hexapod, limb, np.array(start), friction=FRICTION)
    torques = gravity_torques(hexapod, limb, found)
    turned = np.abs(found - start) > 1e-3
    free = (found > hexapod.lower[hexapod.joint_indices(limb)] + 1e-6) & turned
    assert np.abs(torques).max() < FRICTION + 1e-3
    np.testing.assert_allclose(np.abs(torques[free]), FRICTION, atol=2e-3)
    assert (np.sign(torques[free]) == np.sign(start - found)[free]).all(), "downhill"
    assert turned[1], "it falls"


def test_the_lowest_point_of_a_limb_that_stands_is_below_its_foot(hexapod: RobotModel) -> None:
    joints = hexapod.nominal.posture[hexapod.joint_indices(hexapod.limb("L2"))]
    assert lowest_point(hexapod, hexapod.limb("L2"), joints) == pytest.approx(-hexapod.nominal.body_height, abs=1e-4)
    up = np.array([0.0, 1.5, -1.0])  # the knee above the hip, the foot beside it: the housing of the joint is lowest
    assert lowest_point(hexapod, hexapod.limb("L2"), up) > 0.0


def test_a_raised_robot_stands_on_all_feet_and_lifts_what_hangs(hexapod: RobotModel) -> None:
    hangs = {"L2": np.array([0.0, -0.9, -0.55])}
    higher = raised(hexapod, hangs)
    assert higher is not None
    assert higher.nominal.body_height == pytest.approx(hanging_height(hexapod, hangs))
    assert higher.nominal.body_height == pytest.approx(SPARE_M - lowest_point(hexapod, hexapod.limb("L2"), hangs["L2"]))
    assert not touches(higher, hangs)
    base = np.array([0.0, 0.0, higher.nominal.body_height, 0.0, 0.0, 0.0])
    feet = higher.foot_positions(base, higher.nominal.posture)
    np.testing.assert_allclose(feet[:, 2], [limb.foot.radius for limb in hexapod.limbs], atol=2e-4)
    before = hexapod.foot_positions(np.zeros(6), hexapod.nominal.posture)
    assert (np.abs(feet[:, 1]) < np.abs(before[:, 1])).all(), "legs that reach further down stand nearer to the body"


def test_a_robot_stands_as_high_as_it_goes_where_a_limb_still_touches(hexapod: RobotModel) -> None:
    hangs = {"L1": np.array([0.0, -0.85, -1.22])}
    higher = raised(hexapod, hangs)
    assert higher is not None
    assert touches(higher, hangs)
    assert hanging_height(hexapod, hangs) - LIGHT_M <= higher.nominal.body_height < hanging_height(hexapod, hangs)


def test_a_limb_that_hangs_straight_is_too_long_for_any_stance(hexapod: RobotModel) -> None:
    assert raised(hexapod, {"L1": np.array([0.0, -1.5, 0.0])}) is None


def test_a_limb_that_hangs_high_needs_no_other_stance(hexapod: RobotModel) -> None:
    assert raised(hexapod, {"L2": np.array([0.0, 1.5, -1.0])}) is hexapod


def test_a_fold_goes_down_and_up_on_feet_that_stay(hexapod: RobotModel, folded: tuple[MotionPlan, Folded]) -> None:
    stand, fold = folded
    down, up = fold.plans
    assert down.base_poses[-1, 2] < 0.05
    assert up.base_poses[-1, 2] == pytest.approx(stand.base_poses[-1, 2], abs=1e-6)
    np.testing.assert_allclose(up.joint_positions[:, 0], down.joint_positions[:, -1], atol=1e-9)
    for plan in (down, up):
        assert plan.pattern.columns == COLUMNS
        assert plan.limp == ("L2",)
        assert plan.report.details["slip_m"] < 0.004
        assert plan.report.details["penetration_m"] < 0.001, "what is limp gives way, and does not count"
        assert plan.report.details["zmp_margin_m"] > 0.03
    assert set(fold.postures) == {"L2"}


def test_a_limb_that_friction_would_hold_up_is_not_folded(hexapod: RobotModel) -> None:
    stand = standing(hexapod, ("L2",))
    with pytest.raises(UnsolvedError, match="stay up"):
        plan_fold(hexapod, stand, stand.roles, ("L2",), 5.0)


@pytest.mark.parametrize("simulator", [PyBulletSimulator(), MujocoSimulator()], ids=["pybullet", "mujoco"])
def test_both_simulators_fold_the_limb_as_planned(
    hexapod: RobotModel, folded: tuple[MotionPlan, Folded], simulator: PyBulletSimulator | MujocoSimulator
) -> None:
    stand, fold = folded
    timeline = build_timeline(hexapod, [(stand, 1), *((plan, 1) for plan in fold.plans)])
    trace = simulator.run(hexapod, timeline, Scene())
    rows = hexapod.joint_indices(hexapod.limb("L2"))
    low = np.searchsorted(trace.times, timeline.entries[1].end)
    np.testing.assert_allclose(trace.joint_positions[low, rows], fold.plans[0].joint_positions[rows, -1], atol=0.2)
    assert trace.joint_positions[-1, rows[2]] < -0.35, "bent for good"


def test_a_rise_ends_where_the_start_begins(hexapod: RobotModel) -> None:
    start = replace(standing(hexapod, ("L2",)), name="start")
    rise, (down, up) = plan_rise(hexapod, start, 0.09), plan_dip(hexapod, start)
    assert rise.base_poses[0, 2] == pytest.approx(0.09, abs=1e-6)
    for plan in (rise, up):
        np.testing.assert_allclose(plan.joint_positions[:, -1], start.joint_positions[:, 0], atol=1e-9)
        np.testing.assert_allclose(plan.base_poses[-1], start.base_poses[0], atol=1e-9)
    assert down.base_poses[-1, 2] < start.base_poses[0, 2] - 0.02


def test_a_way_back_is_the_way_backwards(folded: tuple[MotionPlan, Folded]) -> None:
    down = folded[1].plans[0]
    back = backwards(down, "back")
    times = np.linspace(0.0, down.duration, 33)
    np.testing.assert_allclose(back.joint_spline(times), down.joint_spline(down.duration - times), atol=1e-9)
    np.testing.assert_allclose(back.base_spline(times), down.base_spline(down.duration - times), atol=1e-9)
    np.testing.assert_array_equal(back.pattern.contact, down.pattern.contact[:, ::-1])
