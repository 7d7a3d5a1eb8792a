"""Boxes in a grasp, in PyBullet: held, put down, and dropped."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import gaitforge as gf
from gaitforge.motion.manipulation.footing import under_load
from gaitforge.motion.manipulation.inverse import tip_joints
from gaitforge.motion.manipulation.pick_place import Carried, State, carry, plan_pick, plan_place
from gaitforge.motion.timeline import Entry
from gaitforge.motion.timeline_build import build_timeline
from gaitforge.robot.model import RobotModel
from gaitforge.robot.rotation import quaternions
from gaitforge.task.handling import GraspKind, Pick
from gaitforge.task.scene import Scene, SceneObject
from gaitforge.verify.grasps import load_errors
from gaitforge.verify.mujoco import MujocoSimulator
from gaitforge.verify.pybullet import PyBulletSimulator
from gaitforge.verify.simulator import Simulator
from gaitforge.verify.verdict import Verdict
from gaitforge.verify.verify import verify_timeline

BOX = SceneObject("box", "box", (0.33, 0.0, 0.06), size=(0.16, 0.25, 0.12), mass=0.5)
WALKING = ("L2", "L3", "R2", "R3")


def standing(robot: RobotModel, carried: Carried, ahead: float = 0.0) -> State:
    """At rest with the box, the feet around the centre of mass with it, and the body `ahead` [m] of that."""
    held = robot.nominal.held_posture.copy()
    for name, q in carried.joints.items():
        held[robot.joint_indices(robot.limb(name))] = q
    grasping = replace(robot, nominal=replace(robot.nominal, held_posture=held)).carrying(carried.load)
    joints = under_load(grasping, WALKING).nominal.posture.copy()
    feet = robot.foot_positions(np.zeros(6), joints) - [ahead, 0.0, 0.0]
    for index, limb in enumerate(robot.limbs):
        rows = robot.joint_indices(limb)
        walks = limb.name in WALKING
        joints[rows] = tip_joints(robot, limb, feet[index : index + 1], joints[rows])[0] if walks else held[rows]
    return State(np.array([0.0, 0.0, robot.nominal.body_height, 0.0, 0.0, 0.0]), joints)


def lifted_and_put_down(
    robot: RobotModel, squeeze: float, grasp: GraspKind = "friction", simulator: Simulator | None = None
) -> Verdict:
    """A hexapod on its four rear legs takes a box from the ground, and puts it back."""
    carried = carry(robot, BOX, Pick("box", ("L1", "R1"), squeeze, grasp=grasp), (0.0, 0.0, 0.0))
    rest = standing(robot, carried)
    plans = [*plan_pick(robot, carried, rest, {}), *plan_place(robot, carried, rest, {}, 0.0)]
    return verify_timeline(robot, build_timeline(robot, [(plan, 1) for plan in plans]), Scene((BOX,)), simulator)


@pytest.fixture(scope="module")
def hexapod() -> RobotModel:
    return gf.load_robot("hexapod")


@pytest.fixture(scope="module")
def verdict(hexapod: RobotModel) -> Verdict:
    return lifted_and_put_down(hexapod, 25.0)


def test_a_box_is_lifted_held_and_put_down(verdict: Verdict) -> None:
    assert verdict.passed, verdict.failed
    height = verdict.trace.objects["box"][:, 2]
    assert height[0] == pytest.approx(0.06, abs=1e-3)
    assert height.max() == pytest.approx(0.10, abs=2e-3)
    assert height[-1] == pytest.approx(0.06, abs=1e-3)
    named = {(c.name, c.segment) for c in verdict.checks}
    assert {("load_place", "box_lift"), ("load_angle", "box_open")} <= named
    margins = {c.segment: (c.value, c.limit) for c in verdict.checks if c.name == "static_margin"}
    assert all(limit == 0.0 for _, limit in margins.values())
    assert min(value for value, _ in margins.values()) > 10.0


def test_the_squeeze_is_what_was_asked_for(verdict: Verdict) -> None:
    """Newton: with the tips at rest on the box, the servo's torque over its lever about the vertical axis of J1."""
    trace, robot = verdict.trace, verdict.timeline.robot
    (lift,) = (e for e in verdict.timeline.entries if e.plan.name == "box_lift")
    row = int(np.searchsorted(trace.times, lift.end - 0.05))
    feet = robot.foot_positions(np.zeros(6), trace.joint_positions[row])
    lever = feet[0, 0] - 0.125  # [m] from the axis of J1, the force being along y
    torque = abs(trace.joint_torques[row, robot.joint_names.index("L1_J1")])
    assert torque / lever == pytest.approx(25.0, rel=0.1)


def test_the_centre_of_mass_of_a_trace_counts_the_box_while_it_is_borne(verdict: Verdict) -> None:
    trace, robot = verdict.trace, verdict.timeline.robot
    for name, share in (("box_close", 0.0), ("box_lift", 0.5 / (robot.mass + 0.5))):
        (entry,) = (e for e in verdict.timeline.entries if e.plan.name == name)
        row = int(np.searchsorted(trace.times, entry.end - 0.1))
        own = robot.center_of_mass(trace.base_poses[row], trace.joint_positions[row])
        np.testing.assert_allclose(trace.com[row], own + share * (trace.objects["box"][row, :3] - own), atol=1e-5)


def test_the_feet_bear_the_share_of_the_box_that_the_tips_do(verdict: Verdict) -> None:
    """Their centre of pressure, by the forces, is c_λ = (M c + λ m b) / (M + λ m), λ by the sum of the forces."""
    trace, robot = verdict.trace, verdict.timeline.robot
    for name, shares in (("box_reach", (-0.1, 0.1)), ("box_lift", (0.9, 1.1))):
        (entry,) = (e for e in verdict.timeline.entries if e.plan.name == name)
        rows = slice(*np.searchsorted(trace.times, [entry.end - 0.3, entry.end]))
        force = trace.normal_force[rows].mean(axis=0)
        pressure = force @ trace.contact_points[rows, :, :2].mean(axis=0) / force.sum()
        own = np.mean([
            robot.center_of_mass(base, q)
            for base, q in zip(trace.base_poses[rows], trace.joint_positions[rows], strict=True)
        ], axis=0)  # fmt: skip
        box, share = trace.objects["box"][rows, :3].mean(axis=0), (force.sum() / 9.81 - robot.mass) / 0.5
        expected = (robot.mass * own + share * 0.5 * box) / (robot.mass + share * 0.5)
        assert shares[0] < share < shares[1]
        np.testing.assert_allclose(pressure, expected[:2], atol=4e-3)


@pytest.mark.parametrize(("ahead", "stands"), [(0.045, True), (0.07, False)])
def test_a_robot_with_a_margin_below_zero_tips_over_when_the_box_is_let_go(
    hexapod: RobotModel, monkeypatch: pytest.MonkeyPatch, ahead: float, stands: bool
) -> None:
    """Tips hold a box on the ground; then they open, the body `ahead` [m] of where it would be."""
    for name, value in (("SHIFT", 0.0), ("LEAST_MARGIN", -1.0)):  # the planner would not let it stand like that
        monkeypatch.setattr(f"gaitforge.motion.manipulation.pick_place.{name}", value)
    monkeypatch.setattr("gaitforge.motion.manipulation.grasp.DEPTH", 0.002)  # the run begins with tips closed
    carried = carry(hexapod, BOX, Pick("box", ("L1", "R1")), (0.0, 0.0, 0.0))
    rest = standing(hexapod, carried, ahead)
    _, opened, retract = plan_place(hexapod, carried, rest, {}, 0.0)
    place = rest.base[:3] + opened.holdings[0].poses[0, :3]
    scene = Scene((replace(BOX, xyz=tuple(place.tolist())),))
    timeline = build_timeline(hexapod, [(opened, 1), (retract, 1)])
    verdict = verify_timeline(hexapod, timeline, scene, simulator=MujocoSimulator())
    margin = next(c for c in verdict.checks if (c.name, c.segment) == ("static_margin", "box_open"))
    tilt = np.degrees(np.abs(verdict.trace.base_poses[:, 3:5]).max())
    assert (margin.passed, tilt < 3.0) == (stands, stands), (margin.value, tilt)


def test_a_box_that_is_squeezed_too_little_is_not_kept(hexapod: RobotModel) -> None:
    loose = lifted_and_put_down(hexapod, 2.0)
    assert {c.name for c in loose.failed} >= {"load_place"}
    assert loose.trace.objects["box"][:, 2].max() < 0.08


def test_load_errors_are_a_distance_and_an_angle_in_the_body_frame() -> None:
    base = np.array([[1.0, 2.0, 0.1, 0.0, 0.0, np.pi / 2]])
    planned = np.array([[0.3, 0.0, 0.0, 0.0, 0.0, 0.0]])
    exact = np.array([[1.0, 2.3, 0.1, *quaternions([0.0, 0.0, np.pi / 2])]])
    far, turned = load_errors(base, exact, planned)
    assert (far[0], turned[0]) == (pytest.approx(0.0, abs=1e-12), pytest.approx(0.0, abs=1e-7))
    other = np.array([[1.0, 2.3, 0.13, *quaternions([0.2, 0.0, np.pi / 2])]])
    far, turned = load_errors(base, other, planned)
    assert (far[0], turned[0]) == (pytest.approx(0.03), pytest.approx(0.2))


@pytest.mark.parametrize("simulator", [PyBulletSimulator(), MujocoSimulator()], ids=["pybullet", "mujoco"])
def test_a_weld_holds_what_tips_that_hardly_press_would_drop_and_lets_go_when_they_open(
    hexapod: RobotModel, simulator: Simulator
) -> None:
    """A squeeze of 2 N: by friction the box stays where it is."""
    slack = lifted_and_put_down(hexapod, 2.0, simulator=simulator)
    welded = lifted_and_put_down(hexapod, 2.0, "weld", simulator)
    assert slack.welded == ()
    assert welded.welded == ("box",)
    lift, retract = (_entry(welded, name) for name in ("box_lift", "box_retract"))
    heights = [v.trace.objects["box"][np.searchsorted(v.trace.times, lift.end), 2] for v in (slack, welded)]
    assert heights[0] < 0.08
    assert heights[1] == pytest.approx(0.10, abs=3e-3)
    assert welded.passed, welded.failed
    rows = welded.trace.times >= retract.start
    box = welded.trace.objects["box"][rows]
    assert np.ptp(box[:, :3], axis=0).max() < 1e-3, "limbs that go away leave it"


def _entry(verdict: Verdict, name: str) -> Entry:
    return next(e for e in verdict.timeline.entries if e.plan.name == name)
