"""Pointing, line of sight and pictures of a camera on a limb."""

import io
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pinocchio
import pytest
from PIL import Image
from walkers import HEIGHT, OPTICAL, posture, stand_plan, timeline_of, walker

from gaitforge.motion.timeline import Aim, Timeline
from gaitforge.robot.model import Capsule, RobotModel
from gaitforge.robot.rotation import matrices
from gaitforge.task.scene import Scene, SceneObject
from gaitforge.verify.clips import render_clip
from gaitforge.verify.execution import planned_rows
from gaitforge.verify.feedback import AimFeedback
from gaitforge.verify.mujoco import MujocoSimulator
from gaitforge.verify.pictures import render
from gaitforge.verify.pointing import pointing_angle
from gaitforge.verify.pybullet import PyBulletSimulator
from gaitforge.verify.pybullet.camera import focal_length
from gaitforge.verify.sight import clear_of_camera
from gaitforge.verify.trace import Trace
from gaitforge.verify.verdict import Verdict
from gaitforge.verify.verify import judge, verify_timeline

Seen = Callable[..., Trace]
ROBOT = walker(3, camera="R1")
CAMERA = ROBOT.tools[0]
BASE = np.array([0.0, 0.0, HEIGHT, 0.0, 0.0, 0.0])
T_WORLD_CAMERA = ROBOT.link_pose(CAMERA.link, BASE, posture(3)) @ OPTICAL
EYE, AXIS = T_WORLD_CAMERA[:3, 3], T_WORLD_CAMERA[:3, 2]
AHEAD = EYE + 1.5 * AXIS


def timeline(target: np.ndarray, start: float = 0.0, duration: float = 0.3, kind: str = "stand") -> Timeline:
    plan = stand_plan(ROBOT, duration)
    object.__setattr__(plan, "kind", kind)
    return timeline_of(ROBOT, (plan, 1), aims=(Aim("R1", "camera", target, start, duration),))


@pytest.fixture(params=[PyBulletSimulator(), MujocoSimulator()], ids=["pybullet", "mujoco"])
def seen(request: pytest.FixtureRequest) -> Seen:
    """What a simulator's camera does when it is to look at a target among objects."""
    return lambda target, *objects: request.param.run(ROBOT, timeline(target), Scene(objects))


def test_the_pointing_angle_is_that_of_pinocchios_camera() -> None:
    random = np.random.default_rng(1)
    for _ in range(20):
        pose = np.concatenate([random.uniform(-1, 1, 3), random.uniform(-1, 1, 3)])
        q, target = random.uniform(-1, 1, 18), random.uniform(-3, 3, 3)
        data = ROBOT.pin.createData()
        pinocchio.framesForwardKinematics(ROBOT.pin, data, ROBOT.configuration(pose, q))
        frame = ROBOT.pin.getFrameId(CAMERA.link, pinocchio.FrameType.BODY)
        camera = data.oMf[frame] * pinocchio.SE3(OPTICAL)
        seen_from = camera.actInv(target)  # the target in the optical frame: on the axis it is (0, 0, d)
        expected = np.arccos(seen_from[2] / np.linalg.norm(seen_from))
        T = (ROBOT.link_pose(CAMERA.link, pose, q) @ OPTICAL)[None]
        assert pointing_angle(T, target)[0] == pytest.approx(expected, abs=1e-9)


def test_a_camera_on_its_target_points_well_and_one_beside_it_does_not(seen: Seen) -> None:
    aside = AHEAD + 1.5 * np.tan(np.radians(5.0)) * np.array([1.0, 0.0, 0.0])
    assert np.degrees(seen(AHEAD).pointing["camera"].max()) < 0.2
    assert np.degrees(seen(aside).pointing["camera"].max()) == pytest.approx(5.0, abs=0.3)


@pytest.mark.parametrize("simulator", [PyBulletSimulator, MujocoSimulator])
def test_a_camera_that_is_aimed_by_the_measured_pose_finds_a_target_that_the_plan_misses(
    simulator: type[PyBulletSimulator] | type[MujocoSimulator],
) -> None:
    above = AHEAD + 1.5 * np.tan(np.radians(5.0)) * np.array([0.0, 0.0, 1.0])
    timed = timeline(above, start=0.1, duration=0.5)
    angles = np.degrees(simulator(aim_feedback_hz=60.0).run(ROBOT, timed, Scene()).pointing["camera"])
    times = np.arange(len(angles)) * 0.5 / (len(angles) - 1)
    assert np.nanmax(angles[times < 0.11]) > 4.0
    assert angles[times > 0.3].max() < 0.1


def test_a_body_that_is_turned_is_what_the_camera_is_aimed_from() -> None:
    """Between two corrections an aimed limb keeps the last one; the joints of others are as planned."""
    turned = np.array([0.02, -0.01, HEIGHT + 0.005, 0.01, -0.02, 0.08])

    class Measured:
        def link_pose(self, link: str) -> tuple[np.ndarray, np.ndarray]:
            assert link == ROBOT.base_link
            return matrices(turned[3:]), turned[:3]

    timed = timeline(AHEAD)
    plan = planned_rows(timed, 240.0)
    feedback = AimFeedback(Measured(), ROBOT, timed, plan, 60.0)
    rows = np.array([feedback.positions(row) for row in range(5)])
    limb = ROBOT.joint_indices(ROBOT.limb("R1"))
    aimed = rows[0, limb]
    T = (ROBOT.link_pose(CAMERA.link, turned, rows[0]) @ OPTICAL)[None]
    before = (ROBOT.link_pose(CAMERA.link, turned, plan.joint_positions[0]) @ OPTICAL)[None]
    assert np.degrees(pointing_angle(before, AHEAD)[0]) > 3.0
    assert np.degrees(pointing_angle(T, AHEAD)[0]) < 1e-3
    np.testing.assert_allclose(rows[:, limb], np.tile(aimed, (5, 1)), atol=1e-9)
    others = np.setdiff1d(np.arange(18), limb)
    np.testing.assert_array_equal(rows[:, others], plan.joint_positions[:5, others])
    as_planned = AimFeedback(Measured(), ROBOT, timed, plan, 0.0)
    np.testing.assert_array_equal(as_planned.positions(3), plan.joint_positions[3])


def judged(target: np.ndarray, *objects: SceneObject) -> Verdict:
    return verify_timeline(ROBOT, timeline(target, kind="gait"), Scene(objects))


def test_a_gait_is_judged_by_where_its_camera_points() -> None:
    aside = AHEAD + 1.5 * np.tan(np.radians(5.0)) * np.array([1.0, 0.0, 0.0])
    assert "camera_pointing" not in {c.name for c in judged(AHEAD).failed}
    assert "camera_pointing" in {c.name for c in judged(aside).failed}


def test_a_camera_that_is_aimed_from_the_measured_pose_is_judged_more_strictly() -> None:
    """2° off its target: good enough as planned, too far for one that knows where the body is."""
    aside = AHEAD + 1.5 * np.tan(np.radians(2.0)) * np.array([1.0, 0.0, 0.0])
    open_loop = judged(aside)
    closed = replace(open_loop.trace, aim_feedback_hz=60.0)
    again = judge(ROBOT, open_loop.timeline, closed, "pybullet")
    (before,), (after,) = ([c for c in v.checks if c.name == "camera_pointing"] for v in (open_loop, again))
    assert before.value == after.value == pytest.approx(2.0, abs=0.3)
    assert (before.limit, before.passed, after.limit, after.passed) == (2.5, True, 1.0, False)


@pytest.mark.parametrize("simulator", [PyBulletSimulator, MujocoSimulator])
def test_a_run_says_whether_the_camera_was_aimed_from_the_measured_pose(
    simulator: type[PyBulletSimulator] | type[MujocoSimulator],
) -> None:
    for rate in (0.0, 60.0):
        trace = simulator(aim_feedback_hz=rate).run(ROBOT, timeline(AHEAD, duration=0.1), Scene())
        assert trace.aim_feedback_hz == rate


def test_before_the_aim_begins_there_is_no_angle() -> None:
    trace = PyBulletSimulator().run(ROBOT, timeline(AHEAD, start=0.2), Scene())
    angle = trace.pointing["camera"]
    assert np.isnan(angle[trace.times < 0.199]).all()
    assert np.isfinite(angle[trace.times > 0.201]).all()


def test_a_box_between_camera_and_target_blocks_the_sight(seen: Seen) -> None:
    half_way = EYE + 0.7 * AXIS
    wall = SceneObject("wall", "box", tuple(half_way), size=(0.1, 0.1, 0.1))
    assert seen(AHEAD).sight["camera"].all()
    assert not seen(AHEAD, wall).sight["camera"].any()
    assert "line_of_sight" in {c.name for c in judged(AHEAD, wall).failed}


def test_a_box_beside_the_line_does_not_block_it(seen: Seen) -> None:
    beside = EYE + 0.7 * AXIS + np.array([0.2, 0.0, 0.0])
    assert seen(AHEAD, SceneObject("wall", "box", tuple(beside), size=(0.1, 0.1, 0.1))).sight["camera"].all()


def test_the_box_that_is_looked_at_does_not_block_the_sight_of_its_own_centre(seen: Seen) -> None:
    assert seen(AHEAD, SceneObject("target", "box", tuple(AHEAD), size=(0.2, 0.2, 0.2))).sight["camera"].all()


def pipe_towards(direction: np.ndarray) -> SceneObject:
    """A pipe with its opening at AHEAD whose axis runs along a horizontal `direction`."""
    yaw = float(np.arctan2(direction[1], direction[0]))
    return SceneObject("pipe", "pipe", tuple(AHEAD), (0.0, 0.0, yaw), radius=0.1, length=0.5)


def test_the_opening_of_a_pipe_is_seen_from_the_front_and_not_through_its_wall(seen: Seen) -> None:
    assert seen(AHEAD, pipe_towards(AXIS)).sight["camera"].all()
    behind = -AXIS + np.array([0.6, 0.0, 0.0])  # the body of the pipe comes slantwise towards the camera
    assert not seen(AHEAD, pipe_towards(behind)).sight["camera"].any()


def test_another_limb_in_front_of_the_camera_blocks_the_sight(seen: Seen) -> None:
    foot = ROBOT.foot_positions(BASE, posture(3))[ROBOT.limb_names.index("L2")]
    through = foot + (foot - EYE) / np.linalg.norm(foot - EYE) * 0.5
    assert not seen(through).sight["camera"].any()


def with_capsules(*capsules: Capsule) -> RobotModel:
    robot = walker(3, camera="R1")
    object.__setattr__(robot, "capsules", capsules)
    return robot


def test_a_ray_starts_outside_of_the_shapes_that_hold_the_camera() -> None:
    eye = OPTICAL[:3, 3]
    around = Capsule(CAMERA.link, (eye[0] - 0.1, 0.0, 0.0), (eye[0] + 0.03, 0.0, 0.0), 0.02)
    elsewhere = Capsule(CAMERA.link, (0.2, 0.0, 0.0), (0.3, 0.0, 0.0), 0.02)
    assert clear_of_camera(with_capsules(), CAMERA) == pytest.approx(0.005)
    assert clear_of_camera(with_capsules(around, elsewhere), CAMERA) == pytest.approx(0.055, abs=0.002)


def test_the_camera_takes_pictures_of_what_is_ahead() -> None:
    target = SceneObject("target", "box", tuple(AHEAD), size=(0.3, 0.3, 0.3))
    simulator = PyBulletSimulator(camera_hz=10.0, camera_size=(64, 48))
    with_box, without = (simulator.run(ROBOT, timeline(AHEAD), Scene(s)).images for s in ((target,), ()))
    assert [t for t, _ in with_box] == pytest.approx([0.0, 0.1, 0.2, 0.3])
    boxed, empty = (np.asarray(Image.open(io.BytesIO(images[-1][1])), dtype=float) for images in (with_box, without))
    assert boxed.shape == (48, 64, 3)
    changed = np.argwhere(np.abs(boxed - empty).sum(axis=2) > 30)
    middle = changed.mean(axis=0)
    assert middle == pytest.approx([23.5, 31.5], abs=3.0)  # the optical axis goes through the box
    width = 0.3 / (1.5 - 0.15) * focal_length(48, simulator.camera_fov_deg)
    assert np.ptp(changed[:, 1]) == pytest.approx(width, abs=3.0)


def test_pictures_of_a_run_show_the_robot_and_have_the_asked_size(seen: Seen) -> None:
    trace = seen(AHEAD)
    pictures = render(ROBOT, trace, Scene(), [0.0, 0.2], size=(160, 90))
    pixels = [np.asarray(Image.open(io.BytesIO(png))) for png in pictures]
    assert [p.shape for p in pixels] == [(90, 160, 3)] * 2
    middle = pixels[0][30:60, 60:100].reshape(-1, 3).astype(float)
    assert middle.std() > 10.0
    assert render(ROBOT, trace, Scene(), []) == []


def test_a_clip_shows_the_run_as_fast_as_it_went_and_shows_it_move() -> None:
    trace = PyBulletSimulator().run(ROBOT, timeline(AHEAD, duration=0.5), Scene())
    raised = trace.joint_positions.copy()
    raised[:, 1::3] -= np.linspace(0.0, 1.0, len(raised))[:, None]
    lifts = replace(trace, joint_positions=raised)
    clip = Image.open(io.BytesIO(render_clip(ROBOT, lifts, Scene(), frames_hz=8.0, size=(96, 54))))
    assert (clip.size, clip.n_frames) == ((96, 54), 4)
    shown = []
    for index in range(clip.n_frames):
        clip.seek(index)
        shown.append(np.asarray(clip.convert("RGB"), dtype=float))
        assert clip.info["duration"] == 125
    assert np.abs(shown[-1] - shown[0]).max() > 30.0


def test_a_clip_that_would_show_nothing_is_refused() -> None:
    trace = PyBulletSimulator(settle_s=0.0).run(ROBOT, timeline(AHEAD, duration=0.1), Scene())
    with pytest.raises(ValueError, match="shows nothing"):
        render_clip(ROBOT, trace, Scene(), start=0.2)
    with pytest.raises(ValueError, match="shows nothing"):
        render_clip(ROBOT, trace, Scene(), frames_hz=0.0)


def test_a_load_is_drawn_where_the_trace_has_it_and_not_where_it_began() -> None:
    box = SceneObject("box", "box", (0.6, 0.0, 0.05), size=(0.1, 0.1, 0.1), mass=0.5)
    trace = PyBulletSimulator(settle_s=0.0).run(ROBOT, timeline(AHEAD, duration=0.1), Scene((box,)))
    lifted = {"box": trace.objects["box"] + [0.0, 0.0, 0.3, 0.0, 0.0, 0.0, 0.0]}
    below, above = (
        np.asarray(Image.open(io.BytesIO(render(ROBOT, t, Scene((box,)), [0.05], (160, 90), yaw_deg=145.0)[0])), float)
        for t in (trace, replace(trace, objects=lifted))
    )
    wood = [(p[..., 0] - p[..., 2] > 40).nonzero()[0] for p in (below, above)]  # rows of pixels more red than blue
    assert min(map(len, wood)) > 10
    assert wood[1].mean() < wood[0].mean() - 5.0
