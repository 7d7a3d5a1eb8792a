"""Tool limbs look at their target: the optical axis by Pinocchio, along a timeline without jumps."""

from __future__ import annotations

import numpy as np
import pytest

import gaitforge as gf
from gaitforge.errors import InputError
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion.aim import aim_joints, pointing_error
from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.timeline import Timeline
from gaitforge.motion.timeline_build import build_timeline, tool_target
from gaitforge.robot.model import RobotModel
from gaitforge.task.roles import Tool
from gaitforge.task.scene import Scene, SceneObject
from tests.motion.motion_kit import CHANGE, PATIENT, PENTA, TRIPOD

TARGET, OTHER = (2.5, 0.0, 0.3), (2.5, 0.5, 0.3)
BACK = FootfallPattern.from_rows(
    {
        "L1": "00000111111", "L2": "11111111000", "L3": "11111000111",
        "R1": "00111000000", "R2": "11000111111", "R3": "11111111000",
    },
    cyclic=False,
)  # fmt: skip
"""From five walking limbs to six."""


def axis_error(robot: RobotModel, base: np.ndarray, joints: np.ndarray, target: np.ndarray, camera: str) -> float:
    """[rad] between the camera's optical axis and the way to the target, by Pinocchio's frames."""
    tool = next(t for t in robot.tools if t.name == camera)
    pose = robot.link_pose(tool.link, base, joints) @ tool.T_link_tool
    way = target - pose[:3, 3]
    return float(np.arctan2(np.linalg.norm(np.cross(pose[:3, 2], way)), pose[:3, 2] @ way))


@pytest.mark.parametrize("name", ["lookout", "dodecapod"])
def test_the_optical_axis_goes_through_the_target_from_any_base_pose(request: pytest.FixtureRequest, name: str) -> None:
    robot = request.getfixturevalue(name)
    limb, tool = robot.limb("camera"), robot.tool(robot.limb("camera").name)
    rng, rows = np.random.default_rng(2), robot.joint_indices(limb)
    base = rng.normal(0.0, 1.0, (60, 6)) * [0.3, 0.1, 0.02, 0.05, 0.05, 0.15]
    base[:, 2] += robot.nominal.body_height
    joints = np.tile(robot.nominal.held_posture, (60, 1))
    joints[:, rows] = aim_joints(robot, limb, tool, base, np.array(TARGET), robot.nominal.held_posture[rows])
    errors = [axis_error(robot, b, q, np.array(TARGET), "camera") for b, q in zip(base, joints, strict=True)]
    assert max(errors) < 1e-6
    assert (joints[:, rows] > robot.lower[rows]).all()
    assert (joints[:, rows] < robot.upper[rows]).all()


def test_the_pointing_error_is_the_angle_between_axis_and_target(dodecapod: RobotModel) -> None:
    limb, tool = dodecapod.limb("camera"), dodecapod.tool("R2")
    rng, rows = np.random.default_rng(3), dodecapod.joint_indices(limb)
    base = rng.normal(0.0, 0.05, (40, 6))
    base[:, 2] += dodecapod.nominal.body_height
    joints = np.tile(dodecapod.nominal.held_posture, (40, 1))
    joints[:, rows] += rng.normal(0.0, 0.2, (40, len(rows)))
    found = pointing_error(dodecapod, limb, tool, base, joints[:, rows], np.array(TARGET))
    expected = [axis_error(dodecapod, b, q, np.array(TARGET), "camera") for b, q in zip(base, joints, strict=True)]
    assert found == pytest.approx(expected, abs=1e-9)
    assert max(expected) > 0.2


def test_a_camera_that_points_away_from_its_target_is_half_a_turn_off(dodecapod: RobotModel) -> None:
    limb, tool = dodecapod.limb("camera"), dodecapod.tool("R2")
    rows, base = dodecapod.joint_indices(limb), np.array([0, 0, dodecapod.nominal.body_height, 0, 0, 0])
    joints = dodecapod.nominal.held_posture
    pose = dodecapod.link_pose(tool.link, base, joints) @ tool.T_link_tool
    for ahead, angle in ((2.0, 0.0), (-2.0, np.pi)):
        target = pose[:3, 3] + ahead * pose[:3, 2]
        found = pointing_error(dodecapod, limb, tool, base[None], joints[None, rows], target)
        assert found[0] == pytest.approx(angle, abs=1e-6)


def test_a_target_behind_the_robot_is_not_taken_for_one_ahead(dodecapod: RobotModel) -> None:
    """The opposite direction is no solution; where a joint limit is in the way the error says so."""
    limb, tool = dodecapod.limb("camera"), dodecapod.tool("R2")
    rows, base = dodecapod.joint_indices(limb), np.array([[0, 0, dodecapod.nominal.body_height, 0, 0, 0]])
    joints = np.tile(dodecapod.nominal.held_posture, (1, 1))
    for behind in (np.array([-3.0, 2.0, 0.3]), np.array([-3.0, -2.0, 0.3]), np.array([-1.0, 0.0, 2.0])):
        joints[0, rows] = aim_joints(dodecapod, limb, tool, base, behind, dodecapod.nominal.held_posture[rows])[0]
        found = pointing_error(dodecapod, limb, tool, base, joints[:, rows], behind)[0]
        assert found == pytest.approx(axis_error(dodecapod, base[0], joints[0], behind, "camera"), abs=1e-6)
        assert (joints[0, rows] >= dodecapod.lower[rows]).all()
        assert (joints[0, rows] <= dodecapod.upper[rows]).all()


def test_the_joint_that_is_left_over_stays_near_the_posture(dodecapod: RobotModel) -> None:
    """Of all joint positions that point at the target, none that is nearby is nearer to the posture."""
    limb, tool = dodecapod.limb("camera"), dodecapod.tool("R2")
    rows, base = dodecapod.joint_indices(limb), np.array([[0, 0.05, dodecapod.nominal.body_height, 0, 0, 0.05]])
    home = dodecapod.nominal.held_posture[rows]
    q = aim_joints(dodecapod, limb, tool, base, np.array(TARGET), home)
    nearest = np.linalg.norm(q[0] - home)
    for offset in (-0.1, 0.1):
        for joint in range(len(rows)):
            other = aim_joints(dodecapod, limb, tool, base, np.array(TARGET), home + offset * np.eye(len(rows))[joint])
            assert np.linalg.norm(other[0] - home) >= nearest - 1e-6


@pytest.fixture(scope="module")
def walk(lookout: RobotModel) -> MotionPlan:
    return gf.plan_gait(lookout, TRIPOD, samples_per_column=2, options=PATIENT)


@pytest.fixture(scope="module")
def looking(lookout: RobotModel) -> MotionPlan:
    return gf.plan_gait(
        lookout,
        PENTA,
        samples_per_column=2,
        roles={"camera": Tool(TARGET)},
        expected_base=(0.5, 0.0, 0.0),
        options=PATIENT,
    )


@pytest.fixture(scope="module")
def to_looking(lookout: RobotModel, walk: MotionPlan, looking: MotionPlan) -> MotionPlan:
    return gf.plan_transition(lookout, walk, looking, pattern=CHANGE, options=PATIENT)


@pytest.fixture(scope="module")
def back_to_walking(lookout: RobotModel, walk: MotionPlan, looking: MotionPlan) -> MotionPlan:
    return gf.plan_transition(lookout, looking, walk, pattern=BACK, column_s=0.2, options=PATIENT)


@pytest.fixture(scope="module")
def inspection(
    lookout: RobotModel, walk: MotionPlan, looking: MotionPlan, to_looking: MotionPlan, back_to_walking: MotionPlan
) -> Timeline:
    """All limbs, then one looks at a point, then all limbs again."""
    return build_timeline(lookout, [(walk, 1), (to_looking, 1), (looking, 2), (back_to_walking, 1), (walk, 1)])


def test_the_camera_is_on_target_from_the_end_of_the_transition_on(lookout: RobotModel, inspection: Timeline) -> None:
    (aim,) = inspection.aims
    assert (aim.limb, aim.tool, tuple(aim.target)) == ("R1", "camera", TARGET)
    assert aim.start == pytest.approx(inspection.entries[2].start)
    assert aim.end == pytest.approx(inspection.entries[2].end)
    motion = inspection.sample(np.linspace(aim.start, aim.end, 241))
    errors = [
        axis_error(lookout, b, q, aim.target, "camera")
        for b, q in zip(motion.base_poses, motion.joint_positions, strict=True)
    ]
    assert np.degrees(max(errors)) < 0.1


def test_a_camera_that_stayed_in_its_posture_would_miss(lookout: RobotModel, inspection: Timeline) -> None:
    (aim,) = inspection.aims
    motion = Timeline(lookout, inspection.entries).sample([aim.start, aim.end])
    errors = [
        axis_error(lookout, b, q, aim.target, "camera")
        for b, q in zip(motion.base_poses, motion.joint_positions, strict=True)
    ]
    assert np.degrees(max(errors)) > 0.5


def assert_smooth(timeline: Timeline) -> None:
    """Positions are the integral of velocities, and velocities do not jump, all along."""
    count = 8000
    times = np.linspace(0.0, timeline.duration, count * 2 + 1)
    motion, dt = timeline.sample(times), times[1]
    q, v = motion.joint_positions, motion.joint_velocities
    step = q[2::2] - q[:-2:2]
    simpson = (v[:-2:2] + 4 * v[1:-1:2] + v[2::2]) * dt / 3
    assert np.abs(step - simpson).max() < 1e-5
    for t in sorted({e.start for e in timeline.entries[1:]} | {x for _, _, a, b in timeline.overrides for x in (a, b)}):
        if 0 < t < timeline.duration:
            around = timeline.sample([t - 1e-8, t + 1e-8])
            assert np.abs(np.diff(around.joint_positions, axis=0)).max() < 1e-6
            assert np.abs(np.diff(around.joint_velocities, axis=0)).max() < 1e-5


def test_executed_joints_are_smooth_when_a_limb_begins_and_ends_to_look(inspection: Timeline) -> None:
    assert len(inspection.overrides) == 3
    assert_smooth(inspection)


def test_executed_joints_keep_their_speed_limits_while_a_limb_turns_to_its_target(
    lookout: RobotModel, inspection: Timeline
) -> None:
    motion = inspection.sample(np.linspace(0.0, inspection.duration, 4001))
    assert (np.abs(motion.joint_velocities).max(axis=0) < lookout.velocity).all()


def test_the_limb_is_turned_only_while_it_is_off_the_ground(lookout: RobotModel, inspection: Timeline) -> None:
    times = np.linspace(0.0, inspection.duration, 2001)
    plain = Timeline(lookout, inspection.entries).sample(times)
    moved = np.abs(inspection.sample(times).joint_positions - plain.joint_positions).max(axis=1) > 1e-9
    assert moved.any()
    assert not (moved & plain.contact[:, lookout.limb_names.index("R1")]).any()


def test_one_target_may_follow_another(
    lookout: RobotModel, looking: MotionPlan, walk: MotionPlan, to_looking: MotionPlan
) -> None:
    from dataclasses import replace

    again = replace(looking, roles={"R1": Tool(OTHER)})
    still = np.ones((6, 4), dtype=bool)
    still[lookout.limb_names.index("R1")] = False
    first = looking.joint_positions[:, :1]
    # a pause between the two, in the posture of the seam
    pause = replace(
        looking, kind="transition", roles=again.roles, joint_positions=np.tile(first, 5), times=np.linspace(0, 1.0, 5),
        base_poses=np.tile(looking.base_poses[0], (5, 1)), joint_velocity_ends=np.zeros((2, len(first))),
        base_velocity_ends=np.zeros((2, 6)), pattern=FootfallPattern(still, looking.pattern.limbs, cyclic=False),
    )  # fmt: skip
    both = build_timeline(lookout, [(looking, 1), (pause, 1), (again, 1)])
    assert [tuple(a.target) for a in both.aims] == [TARGET, OTHER]
    rows = lookout.joint_indices(lookout.limb("R1"))
    for t in (both.entries[1].start, both.entries[2].start):
        around = both.sample([t - 1e-8, t + 1e-8])
        assert np.abs(np.diff(around.joint_positions[:, rows], axis=0)).max() < 1e-6
        assert np.abs(np.diff(around.joint_velocities[:, rows], axis=0)).max() < 1e-5
    for aim in both.aims:
        motion = both.sample(np.linspace(aim.start + 1e-6, aim.end - 1e-6, 61))
        errors = [
            axis_error(lookout, b, q, aim.target, "camera")
            for b, q in zip(motion.base_poses, motion.joint_positions, strict=True)
        ]
        assert np.degrees(max(errors)) < 0.1


def test_a_point_in_the_body_frame_is_looked_at_by_the_gait_itself(lookout: RobotModel) -> None:
    ahead = (2.0, 0.1, 0.2)
    plan = gf.plan_gait(
        lookout, PENTA, speed=0.03, samples_per_column=1, roles={"camera": Tool(ahead, frame="body")},
        expected_base=(9.0, 9.0, 1.0),
    )  # fmt: skip
    base = np.array([0, 0, lookout.nominal.body_height, 0, 0, 0])
    assert axis_error(lookout, base, plan.joint_positions[:, 0], np.array(ahead), "camera") < 1e-6
    assert build_timeline(lookout, [(plan, 1)]).aims == ()


def test_points_of_the_scene_are_found_by_name_and_others_refused() -> None:
    scene = Scene((SceneObject("pipe", "pipe", TARGET),))
    assert tuple(tool_target(Tool("pipe.opening"), scene)) == TARGET
    assert tuple(tool_target(Tool(OTHER), scene)) == OTHER
    with pytest.raises(InputError, match=r"'pipe.end'; expected one of pipe.opening"):
        tool_target(Tool("pipe.end"), scene)


def test_a_limb_without_a_camera_is_not_asked_to_look(hexapod: RobotModel) -> None:
    with pytest.raises(InputError, match=r"R1.*a limb that carries a camera"):
        gf.plan_gait(hexapod, PENTA, roles={"R1": Tool(look_at=TARGET)})
