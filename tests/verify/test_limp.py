"""Limbs whose motors are off: they fall, what they touch is expected, and they are no support."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import gaitforge as gf
from gaitforge.footfall.given import stand_pattern
from gaitforge.motion.failure.hanging import hanging_joints
from gaitforge.motion.plan import Command, MotionPlan
from gaitforge.motion.timeline_build import build_timeline
from gaitforge.robot.model import RobotModel
from gaitforge.task.scene import Scene
from gaitforge.verify.limp import expected_of_limp, limp_feet
from gaitforge.verify.mujoco import MujocoSimulator
from gaitforge.verify.pybullet import PyBulletSimulator
from gaitforge.verify.trace import Trace, UnplannedContact
from gaitforge.verify.verdict import Verdict
from gaitforge.verify.verify import judge

SIMULATORS = {"pybullet": PyBulletSimulator(), "mujoco": MujocoSimulator()}


@pytest.fixture(scope="module")
def hexapod() -> RobotModel:
    return gf.load_robot("hexapod")


def standing(robot: RobotModel, roles: dict[str, gf.Failed], seconds: float = 0.8) -> MotionPlan:
    """The robot stands; limbs with a role are held off the ground, where they were before their motors went off."""
    joints = robot.nominal.posture.copy()
    for name in roles:
        rows = robot.joint_indices(robot.limb(name))
        joints[rows] = robot.nominal.held_posture[rows]
    base = np.array([0.0, 0.0, robot.nominal.body_height, 0.0, 0.0, 0.0])
    pattern = stand_pattern(robot, 4, free=roles)
    n, n_j, n_f = 9, len(robot.joint_names), len(robot.limbs)
    return MotionPlan(
        name="stand", kind="stand", pattern=pattern, times=np.linspace(0.0, seconds, n),
        joint_positions=np.tile(joints[:, None], n), base_poses=np.tile(base, (n, 1)),
        com=np.tile(robot.center_of_mass(base, joints), (n, 1)),
        feet=np.tile(robot.foot_positions(base, joints), (n, 1, 1)), weights=np.zeros((n, 2, n_f)), command=Command(),
        roles=dict(roles), joint_velocity_ends=np.zeros((2, n_j)), base_velocity_ends=np.zeros((2, 6)),
    )  # fmt: skip


def run(robot: RobotModel, mode: str, simulator: str) -> tuple[Trace, Verdict]:
    before = replace(standing(robot, {"L2": gf.Failed()}, 0.2), name="before")
    timeline = build_timeline(robot, [(before, 1), (standing(robot, {"L2": gf.Failed(mode)}), 1)])
    trace = SIMULATORS[simulator].run(robot, timeline, Scene())
    return trace, judge(robot, timeline, trace, simulator)


@pytest.mark.parametrize("simulator", SIMULATORS)
def test_a_limp_limb_falls_to_the_ground_and_that_is_no_fault(hexapod: RobotModel, simulator: str) -> None:
    trace, verdict = run(hexapod, "limp", simulator)
    foot = hexapod.limb_names.index("L2")
    radius = hexapod.limb("L2").foot.radius
    assert trace.feet[0, foot, 2] - radius > 0.08, "held"
    assert trace.feet[-1, foot, 2] - radius < 0.005, "fallen"
    assert {event.kind for event in trace.unplanned} == {"limp"}
    (count,) = [c for c in verdict.checks if c.name == "limp_contact"]
    assert count.value >= 1
    assert count.limit is None
    assert verdict.passed


@pytest.mark.parametrize("simulator", SIMULATORS)
def test_a_locked_limb_stays_where_it_is(hexapod: RobotModel, simulator: str) -> None:
    trace, verdict = run(hexapod, "locked", simulator)
    rows = hexapod.joint_indices(hexapod.limb("L2"))
    assert np.abs(trace.joint_positions[:, rows] - trace.joint_positions[0, rows]).max() < 0.02
    assert not trace.unplanned
    assert "limp_contact" not in {c.name for c in verdict.checks}


def test_motors_are_off_from_the_failure_on_and_limp_feet_are_no_support(hexapod: RobotModel) -> None:
    before, after = standing(hexapod, {}, 0.2), standing(hexapod, {"R1": gf.Failed("limp"), "L3": gf.Failed("locked")})
    timeline = build_timeline(hexapod, [(replace(before, name="before"), 1), (after, 1)])
    plan = timeline.sample(np.array([0.1, 0.3]))
    limb = hexapod.limb("R1")
    off = [hexapod.joint_names.index(j) for j in (*limb.joints, *limb.tool_joints)]
    expected = np.tile(hexapod.effort, (2, 1))
    expected[1, off] = 0.0
    np.testing.assert_array_equal(plan.efforts, expected)
    feet = limp_feet(timeline, plan.segment)
    assert feet.tolist() == [[False] * 6, [n == "R1" for n in hexapod.limb_names]]


def test_only_what_a_limp_limb_has_a_part_in_is_expected(hexapod: RobotModel) -> None:
    before, after = standing(hexapod, {}, 1.0), standing(hexapod, {"R1": gf.Failed("limp")})
    timeline = build_timeline(hexapod, [(replace(before, name="before"), 1), (after, 1)])
    cases = {
        (0.5, "R1 foot on ground in swing"): "swing",
        (1.2, "R1 foot on ground in swing"): "limp",
        (1.2, "L1 shin against R1 foot"): "limp",
        (1.2, "R1_J2_link against R2 foot"): "limp",
        (1.2, "R2 foot on ground in swing"): "swing",
        (1.2, "L1 foot against R2 shin"): "swing",
    }
    events = [UnplannedContact(t, what, 5.0, t + 0.05, "swing") for t, what in cases]
    assert [e.kind for e in expected_of_limp(events, timeline)] == list(cases.values())


@pytest.mark.parametrize("height", [0.1333, 0.6])
def test_a_limb_hangs_as_low_as_no_other_posture_nearby(hexapod: RobotModel, height: float) -> None:
    """Against a grid over the joints that gravity turns, by Pinocchio's own centre of mass."""
    limb = hexapod.limb("R2")
    rows = hexapod.joint_indices(limb)
    start = hexapod.nominal.held_posture[rows]
    found = hanging_joints(hexapod, limb, start, height)
    assert found[0] == pytest.approx(start[0], abs=1e-3), "gravity does not turn a vertical axis"

    def lowness(q: np.ndarray) -> tuple[float, float]:
        joints = hexapod.nominal.posture.copy()
        joints[rows] = q
        base = np.array([0.0, 0.0, height, 0.0, 0.0, 0.0])
        foot = hexapod.foot_positions(base, joints)[hexapod.limb_names.index("R2"), 2] - limb.foot.radius
        return float(hexapod.center_of_mass(base, joints)[2]), float(foot)

    com, foot = lowness(found)
    assert foot > -1e-6
    near = np.linspace(-0.15, 0.15, 31)
    around = [found + np.array([0.0, a, b]) for a in near for b in near]
    others = [lowness(np.clip(q, hexapod.lower[rows], hexapod.upper[rows])) for q in around]
    assert com <= min(c for c, f in others if f >= 0.0) + 1e-5
    assert com < lowness(start)[0] - 0.005, "it has fallen"


def test_without_balance_the_margin_is_judged_from_when_feet_are_down_and_the_time_before_is_told(
    hexapod: RobotModel,
) -> None:
    """The feet of one side bear nothing for the first 0.3 s of a stand."""
    plan = standing(hexapod, {})
    timeline = build_timeline(hexapod, [(plan, 1)])
    trace = SIMULATORS["pybullet"].run(hexapod, timeline, Scene())
    force = trace.normal_force.copy()
    force[np.ix_(trace.times < 0.3, [limb.side == "right" for limb in hexapod.limbs])] = 0.0
    lame, found = replace(trace, normal_force=force), {}
    for unbalanced in (0.0, 0.35):
        timeline = build_timeline(hexapod, [(replace(plan, unbalanced_s=unbalanced), 1)])
        found[unbalanced] = {c.name: c for c in judge(hexapod, timeline, lame, "pybullet").checks}
    assert not found[0.0]["static_margin"].passed
    assert "unsupported" not in found[0.0]
    assert found[0.35]["static_margin"].passed
    told = found[0.35]["unsupported"]
    assert told.value == pytest.approx(0.3, abs=0.01)
    assert (told.limit, told.unit, told.passed) == (None, "s", True)
