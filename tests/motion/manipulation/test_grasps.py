"""Boxes between limb tips: reach, squeeze, lift, and the stands that do it."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pinocchio
import pytest

from gaitforge.errors import InfeasibleMotion, UnsolvedError
from gaitforge.motion.dense import check_densely
from gaitforge.motion.manipulation.box_gap import box_gap
from gaitforge.motion.manipulation.footing import under_load
from gaitforge.motion.manipulation.grasp import DEPTH
from gaitforge.motion.manipulation.pick_place import Carried, State, carry, plan_pick, plan_place
from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.timeline_build import build_timeline
from gaitforge.robot.model import RobotModel
from gaitforge.robot.payload import Load
from gaitforge.robot.rotation import matrices
from gaitforge.task.handling import Pick
from gaitforge.task.scene import SceneObject

BOX = SceneObject("box", "box", (0.33, 0.0, 0.06), size=(0.16, 0.25, 0.12), mass=0.5)
PICK = Pick("box", ("L1", "R1"), crouch=0.015)
WALKING = ("L2", "L3", "R2", "R3")


@pytest.fixture(scope="module")
def carried(hexapod: RobotModel) -> Carried:
    return carry(hexapod, BOX, PICK, (0.0, 0.0, 0.0))


@pytest.fixture(scope="module")
def standing(hexapod: RobotModel, carried: Carried) -> State:
    """At rest with the box, feet under the load, the body turned and tilted a little as gaits leave it."""
    joints = under_load(_grasping(hexapod, carried), WALKING).nominal.posture.copy()
    for name, q in carried.joints.items():
        joints[hexapod.joint_indices(hexapod.limb(name))] = q
    base = np.array([3.0, -1.0, 0.0, 0.0, -0.03, 0.1])
    feet = hexapod.foot_positions(base, joints)
    walking = [hexapod.limb_names.index(n) for n in WALKING]
    base[4] = 0.0  # four feet in one plane
    base[2] = 0.0254 - hexapod.foot_positions(base, joints)[walking, 2].min()
    assert np.ptp(hexapod.foot_positions(base, joints)[walking, 2]) < 1e-6 < np.ptp(feet[walking, 2])
    return State(base, joints)


def _grasping(robot: RobotModel, carried: Carried) -> RobotModel:
    held = robot.nominal.held_posture.copy()
    for name, q in carried.joints.items():
        held[robot.joint_indices(robot.limb(name))] = q
    return replace(robot, nominal=replace(robot.nominal, held_posture=held)).carrying(carried.load)


@pytest.fixture(scope="module")
def picking(hexapod: RobotModel, carried: Carried, standing: State) -> list[MotionPlan]:
    return plan_pick(hexapod, carried, standing, {})


@pytest.fixture(scope="module")
def placing(hexapod: RobotModel, carried: Carried, standing: State) -> list[MotionPlan]:
    return plan_place(hexapod, carried, standing, {}, 0.0)


def _tips(robot: RobotModel, plan: MotionPlan, column: int) -> np.ndarray:
    return robot.foot_positions(plan.base_poses[column], plan.joint_positions[:, column])


def test_tips_touch_the_sides_of_the_box_all_through_the_lift(
    hexapod: RobotModel, carried: Carried, picking: list[MotionPlan]
) -> None:
    lift = picking[2]
    for k in (0, 7, 24):
        pose, base = lift.holdings[0].poses[k], lift.base_poses[k]
        R = matrices(base[3:])
        local = (_tips(hexapod, lift, k) - base[:3]) @ R - pose[:3]  # body axes: the box is not turned in them
        left, right = local[0], local[3]
        assert 0.125 + 0.0254 - DEPTH - 1e-3 < left[1] < 0.125 + 0.0254 - 0.005  # by one joint, as far as it turns
        np.testing.assert_allclose(left[[0, 2]], [0.0, 0.01], atol=5e-3)
        np.testing.assert_allclose(right, [0.0, -0.125 - 0.0254, 0.01], atol=1e-6)


def test_the_box_stands_where_the_scene_has_it_until_it_is_lifted(picking: list[MotionPlan]) -> None:
    for plan in picking[:2]:
        base, pose = plan.base_poses[-1], plan.holdings[0].poses[-1]
        place = matrices([0.0, 0.0, 0.0]) @ pose[:3] + [0.0, 0.0, base[2]]
        np.testing.assert_allclose(place, BOX.xyz, atol=1e-9)
        assert plan.holdings[0].mass == 0.0
    assert picking[2].holdings[0].mass == 0.5


def test_two_tips_do_not_turn_about_the_sides_of_the_box_while_they_lift_it(
    hexapod: RobotModel, picking: list[MotionPlan]
) -> None:
    turned = []
    for name in ("L1", "R1"):
        link = hexapod.limb(name).foot.link
        first, last = (hexapod.link_pose(link, np.zeros(6), picking[2].joint_positions[:, k])[:3, :3] for k in (0, -1))
        turned.append(np.degrees(pinocchio.log3(last @ first.T)[1]))
    assert np.abs(turned).max() < 1.0
    assert picking[2].holdings[0].poses[-1, 0] < picking[2].holdings[0].poses[0, 0] - 0.01  # drawn in


def test_the_effort_of_the_squeezing_joint_holds_the_force_and_the_limb(hexapod: RobotModel, carried: Carried) -> None:
    """τ of the whole limb by Pinocchio: gravity and a force on the tip."""
    ((joint, effort),) = carried.efforts.items()
    assert joint == "L1_J1"
    q = hexapod.nominal.posture.copy()
    q[hexapod.joint_indices(hexapod.limb("L1"))] = carried.joints["L1"]
    model, data, configuration = hexapod.pin, hexapod.pin.createData(), hexapod.configuration(np.zeros(6), q)
    frame = model.getFrameId(hexapod.limb("L1").foot.link)
    J = pinocchio.computeFrameJacobian(model, data, configuration, frame, pinocchio.LOCAL_WORLD_ALIGNED)
    offset = data.oMf[frame].rotation @ np.array(hexapod.limb("L1").foot.offset)
    tip = J[:3] - pinocchio.skew(offset) @ J[3:]
    weight = pinocchio.computeGeneralizedGravity(model, data, configuration)
    torque = tip.T @ [0.0, -PICK.squeeze, 0.0] + weight
    assert effort == pytest.approx(abs(torque[model.joints[model.getJointId(joint)].idx_v]), rel=1e-5)


def test_four_tips_squeeze_alike_and_lift_straight(dodecapod: RobotModel) -> None:
    box = SceneObject("crate", "box", (0.48, 0.0, 0.1), size=(0.3, 0.5, 0.2), mass=1.0)
    grasp = carry(dodecapod, box, Pick("crate", ("L1", "L2", "R1", "R2"), grip_spread=0.2), (0.0, 0.0, 0.0))
    assert {name.split("_")[0] for name in grasp.efforts} == {"L1", "L2", "R1", "R2"}
    assert grasp.pose[0] == pytest.approx(0.48)
    assert grasp.pose[2] - grasp.grasped[2] == pytest.approx(0.04)


def test_feet_roll_and_do_not_slip_while_the_body_moves_over_them(
    hexapod: RobotModel, picking: list[MotionPlan], placing: list[MotionPlan]
) -> None:
    for plan in (picking[2], placing[0]):
        assert np.abs(plan.base_poses[-1] - plan.base_poses[0]).max() > 0.01
        report = check_densely(hexapod, plan, 0.0)
        assert report.slip < 1e-4
        assert max(report.lift, report.penetration) < 1e-4
        assert report.speed_ratio.max() < 0.5


def test_stages_meet_and_end_where_the_walk_begins(
    picking: list[MotionPlan], placing: list[MotionPlan], standing: State
) -> None:
    for stages in (picking, placing):
        for before, after in pairwise(stages):
            np.testing.assert_allclose(before.joint_positions[:, -1], after.joint_positions[:, 0], atol=1e-6)
            np.testing.assert_allclose(before.base_poses[-1], after.base_poses[0], atol=1e-9)
    np.testing.assert_allclose(picking[-1].joint_positions[:, -1], standing.joints, atol=1e-5)
    np.testing.assert_allclose(placing[0].joint_positions[:, 0], standing.joints, atol=1e-5)


def test_a_box_is_put_on_the_surface_that_is_named(hexapod: RobotModel, carried: Carried, standing: State) -> None:
    lower = plan_place(hexapod, carried, standing, {}, 0.03)[0]
    low = lower.base_poses[-1, 2] + lower.holdings[0].poses[-1, 2]
    assert low == pytest.approx(0.03 + 0.06, abs=1e-9)


def test_the_centre_of_mass_of_a_stage_counts_what_is_borne(hexapod: RobotModel, picking: list[MotionPlan]) -> None:
    for plan, mass in ((picking[1], 0.0), (picking[2], 0.5)):
        base, q = plan.base_poses[-1], plan.joint_positions[:, -1]
        laden = hexapod.carrying(Load(0.5, tuple(plan.holdings[0].poses[-1, :3]))) if mass else hexapod
        np.testing.assert_allclose(plan.com[-1], laden.center_of_mass(base, q), atol=1e-9)


def test_a_box_out_of_reach_is_infeasible(hexapod: RobotModel) -> None:
    far = replace(BOX, xyz=(0.6, 0.0, 0.06))
    with pytest.raises(InfeasibleMotion, match="does not reach"):
        carry(hexapod, far, PICK, (0.0, 0.0, 0.0))


def test_a_limb_that_would_sweep_the_box_away_is_told(hexapod: RobotModel, standing: State) -> None:
    through = carry(hexapod, BOX, replace(PICK, ready_aside=0.005, ready_above=-0.005), (0.0, 0.0, 0.0))
    wide = replace(through, box=replace(BOX, size=(0.16, 0.25, 0.4)))
    with pytest.raises(UnsolvedError, match="near it on its way"):
        plan_pick(hexapod, replace(wide, box=replace(wide.box, size=(0.16, 0.31, 0.12))), standing, {})


def test_the_gap_to_a_box_is_that_of_the_nearest_point_of_the_limb(hexapod: RobotModel) -> None:
    limb = hexapod.limb("L1")
    q = np.array([[1.3, 0.6, -0.9]])
    pose = np.array([[0.33, 0.0, -0.07, 0.0, 0.0, 0.2]])
    joints = hexapod.nominal.posture.copy()
    joints[hexapod.joint_indices(limb)] = q[0]
    R, nearest = matrices(pose[0, 3:]), np.inf
    for capsule in hexapod.capsules:
        if capsule.link in limb.links:
            T = hexapod.link_pose(capsule.link, np.zeros(6), joints)
            for s in np.linspace(0, 1, 200):
                point = T[:3, :3] @ (np.array(capsule.a) * (1 - s) + np.array(capsule.b) * s) + T[:3, 3]
                local = R.T @ (point - pose[0, :3])
                outside = np.maximum(np.abs(local) - [0.08, 0.125, 0.06], 0.0)
                nearest = min(nearest, float(np.linalg.norm(outside)) - capsule.radius)
    assert box_gap(hexapod, limb, q, pose, BOX.size) == pytest.approx(nearest, abs=2e-3)


def test_feet_stand_around_the_laden_centre_of_mass_where_the_nominal_stance_is_too_narrow(
    hexapod: RobotModel, dodecapod: RobotModel, carried: Carried
) -> None:
    laden = _grasping(hexapod, carried)
    robot = under_load(laden, WALKING)
    joints = robot.nominal.posture.copy()
    for name in ("L1", "R1"):
        rows = robot.joint_indices(robot.limb(name))
        joints[rows] = robot.nominal.held_posture[rows]
    walking = [robot.limb_names.index(n) for n in WALKING]
    nominal = laden.foot_positions(np.zeros(6), laden.nominal.posture)[walking]
    feet = robot.foot_positions(np.zeros(6), joints)[walking]
    np.testing.assert_allclose(feet[:, 1:], nominal[:, 1:], atol=1e-6)
    ahead = laden.center_of_mass(np.zeros(6), joints)[0] - feet[:, 0].mean()
    assert abs(ahead) < 0.03 < 0.08 < feet[0, 0] - nominal[0, 0]
    assert under_load(dodecapod, dodecapod.limb_names) is dodecapod


def test_a_timeline_limits_the_squeezing_joint_while_it_holds_and_knows_where_the_box_is_to_be(
    hexapod: RobotModel, picking: list[MotionPlan], carried: Carried
) -> None:
    timeline = build_timeline(hexapod, [(plan, 1) for plan in picking])
    samples = timeline.sample([0.5, picking[0].duration + 0.5, timeline.duration - 1e-6])
    row = hexapod.joint_names.index("L1_J1")
    assert samples.efforts[:, row].tolist() == [7.0, carried.efforts["L1_J1"], carried.efforts["L1_J1"]]
    assert (np.delete(samples.efforts, row, axis=1) == np.delete(hexapod.effort, row)).all()
    np.testing.assert_allclose(samples.loads["box"][0], carried.grasped, atol=1e-9)
    np.testing.assert_allclose(samples.loads["box"][2], carried.pose, atol=1e-6)
