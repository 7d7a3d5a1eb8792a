"""What each topic says, against Pinocchio, SciPy, Pillow and numbers worked out by hand."""

from __future__ import annotations

import io
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image
from run_by_hand import make_verdict
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from gaitforge.motion.feedforward import planned_efforts
from gaitforge.record import write_log
from gaitforge.record.channels.drawings import hull, planned_footholds
from gaitforge.record.channels.footfall import Agreement, agreement, field_name
from gaitforge.record.channels.surroundings import tube
from gaitforge.record.derived import forward_speed
from gaitforge.record.reader import read_run
from gaitforge.record.run import Run
from gaitforge.robot.load import load_robot
from gaitforge.task.scene import SceneObject


def compose(transforms, prefix=""):
    """Link → (4, 4) in the world, by walking up the tree."""
    parents = {t.child_frame_id: t for t in transforms}

    def pose(name):
        if name == "world":
            return np.eye(4)
        t, T = parents[name], np.eye(4)
        q = t.rotation
        T[:3, :3] = Rotation.from_quat([q.x, q.y, q.z, q.w]).as_matrix()
        T[:3, 3] = t.translation.x, t.translation.y, t.translation.z
        return pose(t.parent_frame_id) @ T

    return {name.removeprefix(prefix): pose(name) for name in parents}


@pytest.mark.parametrize(("topic", "prefix"), [("/tf", ""), ("/plan/tf", "plan/")])
def test_all_frames_of_a_stamp_are_one_tree_from_world_to_the_links_where_pinocchio_has_them(
    log, verdict, dodecapod, topic, prefix
):
    links = [link.attrib["name"] for link in ET.fromstring(dodecapod.urdf).findall("link")]
    source = verdict.trace if topic == "/tf" else verdict.trace.plan
    times = verdict.trace.times
    for time, message in list(log.messages(topic))[::97]:
        row = int(np.argmin(np.abs(times - time)))
        children = [t.child_frame_id for t in message.transforms]
        assert sorted(children) == sorted(prefix + link for link in links)
        found = compose(message.transforms, prefix)
        for link in links:
            expected = dodecapod.link_pose(link, source.base_poses[row], source.joint_positions[row])
            assert np.allclose(found[link], expected, atol=1e-9), link


def test_frames_of_prismatic_and_fixed_joints_are_where_pinocchio_has_them():
    import pinocchio

    from gaitforge.record.tree import LinkTree

    urdf = """<robot name="r"><link name="a"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0"
      ixz="0" iyz="0"/></inertial></link><link name="b"/><link name="c"/>
      <joint name="slide" type="prismatic"><parent link="a"/><child link="b"/>
      <origin xyz="0.1 0 0.2" rpy="0.3 0.2 0.1"/><axis xyz="0 1 0"/>
      <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
      <joint name="weld" type="fixed"><parent link="b"/><child link="c"/><origin xyz="0 0.5 0" rpy="1 0 0"/></joint>
      </robot>"""
    model = pinocchio.buildModelFromXML(urdf)
    data = model.createData()
    tree = LinkTree.of(urdf)
    positions = np.array([[0.0], [0.4]])
    poses = tree.world(np.zeros((2, 6)), tree.relative(("slide",), positions))
    for k, q in enumerate(positions):
        pinocchio.framesForwardKinematics(model, data, q)
        for link in ("b", "c"):
            frame = data.oMf[model.getFrameId(link, pinocchio.FrameType.BODY)]
            assert np.allclose(poses[link][k, :3], frame.translation, atol=1e-12)
            assert np.allclose(Rotation.from_quat(poses[link][k, 3:]).as_matrix(), frame.rotation, atol=1e-12)


def test_joint_states_carry_what_was_simulated_and_what_was_planned(log, verdict, dodecapod):
    rows = [int(np.argmin(np.abs(verdict.trace.times - t))) for t, _ in log.messages("/sim/joint_states")]
    trace = verdict.trace
    ahead = planned_efforts(dodecapod, verdict.timeline, trace.plan, 1.0 / (trace.times[1] - trace.times[0]))
    for topic, source, efforts in (
        ("/sim/joint_states", trace, trace.joint_torques),
        ("/plan/joint_states", trace.plan, ahead),
    ):
        messages = [m for _, m in log.messages(topic)]
        assert [j.name for j in messages[0].joints] == list(dodecapod.joint_names)
        positions = np.array([[j.position for j in m.joints] for m in messages])
        velocities = np.array([[j.velocity for j in m.joints] for m in messages])
        assert np.array_equal(positions, source.joint_positions[rows])
        assert np.array_equal(velocities, source.joint_velocities[rows])
        assert np.allclose([[j.effort for j in m.joints] for m in messages], efforts[rows], rtol=1e-9, atol=1e-9)
    assert np.abs(ahead).max() > 0.1


def test_the_ghost_is_the_same_robot_seen_through(log):
    ((_, solid),), ((_, ghost),) = log.messages("/robot_description"), log.messages("/plan/robot_description")
    assert solid["data"] == log.urdf
    ours, theirs = ET.fromstring(ghost["data"]), ET.fromstring(solid["data"])
    assert [x.attrib for x in ours.iter("link")] == [x.attrib for x in theirs.iter("link")]
    colors = [c.attrib["rgba"].split() for v in ours.iter("visual") for c in v.iter("color")]
    assert len(colors) == len(list(theirs.iter("visual"))) > 0
    assert {c[3] for c in colors} == {"0.3"}


def test_meshes_that_can_be_read_are_put_into_the_description_and_others_left(tmp_path):
    from gaitforge.record.description import self_contained

    (tmp_path / "leg.stl").write_bytes(b"solid")
    urdf = f'<robot><mesh filename="{tmp_path}/leg.stl"/><mesh filename="package://other/arm.stl"/></robot>'
    names = [m.attrib["filename"] for m in ET.fromstring(self_contained(urdf)).iter("mesh")]
    assert names == ["data:model/stl;base64,c29saWQ=", "package://other/arm.stl"]


def test_the_footfall_plan_is_c_column_by_column(log, verdict):
    messages = list(log.messages("/footfall/plan"))
    expected = np.concatenate([np.tile(e.plan.pattern.contact, e.cycles) for e in verdict.timeline.entries], axis=1)
    found = np.array([[m[name] for name in log.robot.limb_names] for _, m in messages]).T
    assert np.array_equal(found, expected)
    assert [m["column"] for _, m in messages[4:16]] == list(range(12))
    sampled = verdict.timeline.sample([t + 1e-6 for t, _ in messages])
    assert np.array_equal(sampled.contact.T, expected)


def test_footfall_sim_follows_contacts_that_come_20_ms_late(log):
    planned = [m for _, m in log.messages("/footfall/plan")]
    assert [m for _, m in log.messages("/footfall/sim")] == planned  # 20 ms is less than half of every column


def test_compare_says_late_for_20_ms_after_a_change_and_names_its_states(log, verdict):
    messages = list(log.messages("/footfall/compare"))
    names = {v.name: v.number for v in messages[0][1].DESCRIPTOR.enum_types_by_name["Agreement"].values}
    assert names == {"air": 0, "stance": 1, "early": 2, "late": 3}
    states = [m.L1 for _, m in messages]
    air, stance = Agreement.air, Agreement.stance
    second = 0.5 + 1.0  # L1 stands in the stand and in the first half of the gait
    change = next((t, m.L1) for t, m in messages if stance != m.L1)
    assert change == (pytest.approx(second, abs=1 / 200), Agreement.late)
    after = next((t, m.L1) for t, m in messages if air == m.L1)
    assert after[0] == pytest.approx(second + 0.02, abs=1 / 200)
    assert Agreement.early not in states


def test_agreement_by_hand():
    times = np.arange(10) * 0.1
    planned = np.array([[1, 1, 1, 1, 0, 0, 0, 0, 1, 1]], dtype=bool).T
    actual = np.array([[1, 1, 1, 0, 0, 0, 0, 1, 1, 1]], dtype=bool).T
    a, s, e, late = Agreement.air, Agreement.stance, Agreement.early, Agreement.late
    assert agreement(planned, actual, times)[:, 0].tolist() == [s, s, s, e, a, a, a, e, s, s]
    actual = np.array([[1, 1, 1, 1, 1, 0, 0, 0, 0, 1]], dtype=bool).T
    assert agreement(planned, actual, times)[:, 0].tolist() == [s, s, s, s, late, a, a, a, late, s]


def test_a_foot_that_never_changes_is_early_on_the_ground_and_late_in_the_air():
    times, never = np.arange(4) * 0.1, np.zeros((4, 1), dtype=bool)
    touched = np.array([[0, 1, 0, 0]], dtype=bool).T
    assert agreement(never, touched, times)[:, 0].tolist() == [0, Agreement.early, 0, 0]
    assert agreement(~never, ~touched, times)[:, 0].tolist() == [1, Agreement.late, 1, 1]


def test_limb_names_become_field_names():
    assert [field_name(n) for n in ("L1", "front left", "2nd", "M-1")] == ["L1", "front_left", "_2nd", "M_1"]


def test_the_matrix_shows_swing_red_and_stance_white_where_the_cursor_points(log, verdict):
    ((_, image),) = log.messages("/footfall/matrix")
    pixels = np.array(Image.open(io.BytesIO(image.data)))
    planned = [m for _, m in log.messages("/footfall/plan")]
    for (_, cursor), column in list(zip(log.messages("/footfall/cursor"), planned, strict=True))[::7]:
        corners = np.array([(p.x, p.y) for p in cursor.points[0].points])
        x = int(corners[:, 0].mean())
        top, bottom = corners[:, 1].min(), corners[:, 1].max()
        for k, name in enumerate(log.robot.limb_names):
            y = int(top + (k + 0.5) * (bottom - top) / len(log.robot.limb_names))
            r, g, b = (int(v) for v in pixels[y, x])
            assert ((r, g, b) == (255, 255, 255)) == column[name]
            assert (r > 150 and g < 100 and b < 100) == (not column[name])
        texts = [t.text for t in cursor.texts]
        assert texts == [*log.robot.limb_names, *(e.plan.name for e in verdict.timeline.entries)]


def test_contacts_carry_normal_and_whole_force(log, verdict):
    time, message = list(log.messages("/sim/contacts"))[100]
    row = int(np.argmin(np.abs(verdict.trace.times - time)))
    for k, foot in enumerate(message["feet"]):
        normal, friction = verdict.trace.normal_force[row, k], verdict.trace.friction_force[row, k]
        assert foot["normal_force"] == pytest.approx(normal, abs=1e-6)
        assert foot["force"] == pytest.approx(np.linalg.norm([normal, *friction[:2]]), abs=1e-6)
        assert foot["in_contact"] == bool(normal > 1.0)


def test_metrics_are_in_the_units_they_name(log, verdict):
    values = list(log.messages("/metrics"))
    time, metrics = values[len(values) // 2]
    row = int(np.argmin(np.abs(verdict.trace.times - time)))
    assert metrics["margin"] == pytest.approx(verdict.trace.margin[row], abs=1e-6)
    pose = verdict.trace.base_poses[row]
    up = Rotation.from_euler("xyz", pose[3:]).as_matrix()[2, 2]
    assert metrics["tilt"] == pytest.approx(np.degrees(np.arccos(up)), abs=1e-5)
    assert metrics["speed_planned"] == pytest.approx(0.064, abs=1e-3)
    error = verdict.trace.joint_positions[row] - verdict.trace.plan.joint_positions[row]
    assert metrics["tracking_max"] == pytest.approx(np.abs(error).max(), abs=1e-6)


def test_pointing_is_there_only_while_a_tool_is_aimed(log, verdict):
    (aim,) = verdict.timeline.aims
    name = f"pointing_{next(iter(verdict.trace.pointing))}"
    assert {name in m for t, m in log.messages("/metrics") if t < aim.start - 1e-6} == {False}
    found = {m[name] for t, m in log.messages("/metrics") if t > aim.start + 0.01}
    assert found == {round(float(np.degrees(0.01)), 6)}


def test_forward_speed_of_a_body_that_goes_sideways_is_its_part_along_the_direction():
    times = np.linspace(0.0, 4.0, 401)
    poses = np.zeros((401, 6))
    poses[:, 0], poses[:, 1] = 0.3 * times, 0.4 * times
    direction = np.tile([0.6, 0.8], (401, 1))
    assert np.allclose(forward_speed(poses, direction, times, 0.5), 0.5)
    assert np.allclose(forward_speed(poses, np.tile([-0.8, 0.6], (401, 1)), times, 0.5), 0.0)
    poses[:, 0] = 0.3 * times + 0.01 * np.sin(2 * np.pi * times)
    assert np.allclose(forward_speed(poses, np.tile([1.0, 0.0], (401, 1)), times, 1.0)[60:-60], 0.3, atol=1e-6)


@given(st.lists(st.tuples(st.integers(-9, 9), st.integers(-9, 9)), min_size=4, max_size=14))
def test_the_support_polygon_is_the_convex_hull(points):
    found = np.array(points, dtype=float)
    if np.linalg.matrix_rank(found - found[0]) < 2:
        assert len(hull(found)) <= 2
        return
    expected = ConvexHull(found)
    corners = hull(found)
    assert {tuple(c) for c in corners} == {tuple(found[v]) for v in expected.vertices}
    x, y = corners.T
    assert 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) == pytest.approx(expected.volume)


def test_arrows_stand_on_the_contact_points_and_point_along_the_force(log, verdict):
    time, update = list(log.messages("/viz/forces"))[40]
    row = int(np.argmin(np.abs(verdict.trace.times - time)))
    down = np.flatnonzero(verdict.trace.normal_force[row] > 1.0)
    arrows = update.entities[0].arrows
    assert len(arrows) == len(down) > 0
    for foot, arrow in zip(down, arrows, strict=True):
        q = arrow.pose.orientation
        along = Rotation.from_quat([q.x, q.y, q.z, q.w]).apply([1.0, 0.0, 0.0])
        force = verdict.trace.friction_force[row, foot] + [0.0, 0.0, verdict.trace.normal_force[row, foot]]
        assert np.allclose(along, force / np.linalg.norm(force), atol=1e-9)
        p = arrow.pose.position
        assert np.allclose([p.x, p.y, p.z], verdict.trace.contact_points[row, foot])


def test_footholds_are_under_the_planned_feet_in_the_middle_of_each_stance(log, verdict, dodecapod):
    run, plan = Run(dodecapod, verdict), verdict.trace.plan
    found = planned_footholds(run)
    landings = [np.count_nonzero(np.diff(plan.contact[:, k].astype(int), prepend=0) == 1) for k in range(12)]
    assert [sum(foot == k for foot, _ in found) for k in range(12)] == landings
    stance = np.flatnonzero(plan.contact[:, 0])
    middle = int((stance[0] + stance[np.flatnonzero(np.diff(stance) > 1)[0]] + 1) // 2)  # the first stance of L1
    expected = dodecapod.foot_positions(plan.base_poses[middle], plan.joint_positions[middle])[0]
    point = next(point for foot, point in found if foot == 0)
    assert np.allclose(point, expected - [0.0, 0.0, dodecapod.limbs[0].foot.radius], atol=1e-9)
    ((_, update),) = log.messages("/viz/footholds")
    assert len(update.entities[0].cylinders) == len(found)


def test_a_pipe_is_drawn_as_a_tube_that_is_open_at_its_opening():
    item = SceneObject("pipe", "pipe", (1.0, 2.0, 0.3), radius=0.1, length=0.5, thickness=0.01)
    corners = tube(item)
    assert len(corners) % 3 == 0
    assert corners[:, 0].min() == 0.0
    assert corners[:, 0].max() == 0.5
    distance = np.linalg.norm(corners[:, 1:], axis=1)
    assert np.allclose(np.sort(np.unique(distance.round(9))), [0.09, 0.1])


def test_the_scene_is_drawn_once_and_again_when_a_tool_finds_its_target(log, verdict, dodecapod):
    messages = list(log.messages("/viz/scene"))
    (aim,) = verdict.timeline.aims
    assert [t for t, _ in messages] == pytest.approx([0.0, aim.start, aim.end])
    entities = {e.id: e for e in messages[1][1].entities}
    assert {"pipe", "box"} <= set(entities)
    assert entities["box"].cubes[0].size.x == 0.3
    sphere = entities[f"{aim.tool} target"].spheres[0].pose.position
    assert np.allclose([sphere.x, sphere.y, sphere.z], aim.target)
    sight = entities[f"{aim.tool} sight"]
    mount = next(t for t in dodecapod.tools if t.name == aim.tool)
    start, end = (np.array([p.x, p.y, p.z]) for p in sight.lines[0].points)
    assert sight.frame_id == mount.link
    assert np.allclose(start, mount.T_link_tool[:3, 3])
    assert np.allclose((end - start) / np.linalg.norm(end - start), mount.T_link_tool[:3, 2])
    assert not any(e.lines for e in messages[0][1].entities)
    assert not any(e.lines for e in messages[2][1].entities)


def test_the_report_and_the_log_tell_of_the_failed_check_and_the_unplanned_contact(log):
    assert log.report["verdict"] == "unverified"
    assert log.report["failed"] == 1
    assert [c["passed"] for c in log.report["checks"]] == [True, False, True]
    assert [c["limit"] for c in log.report["checks"]] == ["0.05", "2", ""]
    lines = [(round(t, 3), m.message) for t, m in log.messages("/log")]
    assert lines[0] == (0.0, "unverified in pybullet: 1 of 2 checks hold")
    assert (5.75, "five: tilt 2.4 deg, limit 2") in lines
    assert (3.0, "unplanned contact: L2 shin on ground, 4.2 N") in lines


def test_pictures_of_a_camera_are_logged_when_there_are_some(tmp_path):
    robot = load_robot("hexapod")
    verdict = make_verdict(robot)
    buffer = io.BytesIO()
    Image.new("RGB", (4, 3), (9, 8, 7)).save(buffer, "PNG")
    trace = replace(verdict.trace, images=((0.5, buffer.getvalue()), (0.6, buffer.getvalue())), camera_fov_deg=60.0)
    write_log(tmp_path / "run.mcap", robot, replace(verdict, trace=trace))
    log = read_run(tmp_path / "run.mcap")
    assert [(round(t, 9), m.data) for t, m in log.messages("/camera/image")] == list(trace.images)


def test_the_log_tells_where_in_a_picture_a_point_of_the_world_is(tmp_path):
    """Beside PyBullet's own projection: a target on the optical axis, and one 20° above it, through TF and K."""
    robot = load_robot("dodecapod")
    verdict = make_verdict(robot)
    picture = io.BytesIO()
    Image.new("RGB", (320, 240)).save(picture, "PNG")
    trace = replace(verdict.trace, images=((0.0, picture.getvalue()),), camera_fov_deg=60.0)
    write_log(tmp_path / "run.mcap", robot, replace(verdict, trace=trace))
    log = read_run(tmp_path / "run.mcap")
    ((_, info),), ((_, image),) = log.messages("/camera/info"), log.messages("/camera/image")
    assert (info.width, info.height, info.frame_id) == (320, 240, image.frame_id)
    _, tf = next(iter(log.messages("/tf")))
    (frame,) = (t for t in tf.transforms if t.child_frame_id == info.frame_id)
    camera = next(tool for tool in robot.tools if tool.kind == "camera")
    assert frame.parent_frame_id == camera.link
    q, p = frame.rotation, frame.translation
    R = Rotation.from_quat([q.x, q.y, q.z, q.w]).as_matrix()
    eye = camera.T_link_tool[:3, 3]
    ahead, up = camera.T_link_tool[:3, 2], -camera.T_link_tool[:3, 1]
    for angle in (0.0, np.radians(20.0)):
        point = eye + 2.0 * (np.cos(angle) * ahead + np.sin(angle) * up)
        u, v, w = np.reshape(info.P, (3, 4)) @ np.append(R.T @ (point - [p.x, p.y, p.z]), 1.0)
        rise = 120.0 * np.tan(angle) / np.tan(np.radians(30.0))
        np.testing.assert_allclose([u / w, v / w], [159.5, 119.5 - rise], atol=1e-6)
