"""Limbs, feet and sides recognised in URDF files written by others, and overruled by a YAML beside them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from kit import problems

from gaitforge.robot.load import load_robot
from gaitforge.robot.model import RobotModel
from tests.wheels import bullet, example

# file, leg joints, link of L1's foot, radius of its sphere [m] (as the file has it)
ROBOTS = {
    "pybullet's a1": (lambda: bullet("a1/a1.urdf"), 3, "FL_lower", 0.02),
    "laikago, z up": (lambda: bullet("laikago/laikago_toes_zup.urdf"), 3, "FL_lower_leg", 0.03),
    "aliengo, continuous joints": (lambda: bullet("aliengo/aliengo.urdf"), 3, "FL_lower", 0.0265),
    "a1": (lambda: example("a1_description/urdf/a1.urdf"), 3, "FL_calf", 0.02),
    "go1": (lambda: example("go1_description/urdf/go1.urdf"), 3, "FL_calf", 0.02),
    "laikago": (lambda: example("laikago_description/urdf/laikago.urdf"), 3, "FL_calf", 0.0265),
    "anymal b": (lambda: example("anymal_b_simple_description/robots/anymal.urdf"), 3, "LF_SHANK", 0.031),
    "anymal b with an arm": (
        lambda: example("anymal_b_simple_description/robots/anymal-kinova.urdf"), 3, "LF_SHANK", 0.031,
    ),
    "anymal c": (lambda: example("anymal_c_simple_description/urdf/anymal.urdf"), 3, "LF_SHANK", 0.03),
    "b1 with an arm": (lambda: example("b1_description/urdf/b1-z1.urdf"), 3, "FL_calf", 0.04),
    "hyq": (lambda: example("hyq_description/robots/hyq_no_sensors.urdf"), 3, "lf_lowerleg", 0.02175),
    "solo12, feet without spheres": (lambda: example("solo_description/robots/solo12.urdf"), 3, "FL_LOWER_LEG", None),
    "solo": (lambda: example("solo_description/robots/solo.urdf"), 2, "FL_LOWER_LEG", None),
}  # fmt: skip


@pytest.fixture(scope="module", params=ROBOTS)
def found(request: pytest.FixtureRequest) -> tuple[RobotModel, Path, int, str, float | None]:
    where, joints, link, radius = ROBOTS[request.param]
    return load_robot(where()), where(), joints, link, radius


def test_four_legs_are_found_front_to_rear_and_left_to_right(found) -> None:
    robot, _, joints, link, radius = found
    assert robot.limb_names == ("L1", "L2", "R1", "R2")
    assert [len(x.joints) for x in robot.limbs] == [joints] * 4
    feet = robot.foot_positions(np.zeros(6), robot.nominal.posture)
    assert (np.sign(feet[:, 1]) == [1, 1, -1, -1]).all()
    assert (np.sign(feet[:, 0]) == [1, -1, 1, -1]).all()
    assert robot.limbs[0].foot.link == link
    if radius is not None:
        assert {x.foot.radius for x in robot.limbs} == {radius}
    else:
        assert any("no collision sphere" in w for w in robot.warnings), "a guessed foot is said to be one"


def test_the_whole_mass_of_the_file_is_kept(found) -> None:
    """Merging fixed links loses nothing: the masses that stand in the file, added up."""
    import xml.etree.ElementTree as xml

    robot, path, *_ = found
    masses = [float(m.get("value", 0)) for m in xml.parse(path).getroot().findall("link/inertial/mass")]
    assert robot.mass == pytest.approx(sum(masses), rel=1e-9)


def test_feet_stay_where_pinocchio_has_them_in_the_original_file(found) -> None:
    """Leg tips of the untouched file and of ours, at random joint positions: merged links move no joint."""
    import pinocchio

    robot, path, *_ = found
    original = pinocchio.buildModelFromUrdf(str(path), pinocchio.JointModelFreeFlyer())
    data = original.createData()
    random = np.random.default_rng(3)
    for _ in range(3):
        q = random.uniform(np.maximum(robot.lower, -1.0), np.maximum(np.minimum(robot.upper, 1.0), robot.lower + 0.1))
        configuration = pinocchio.neutral(original)
        for name, angle in zip(robot.joint_names, q, strict=True):
            joint = original.joints[original.getJointId(name)]
            value = [angle] if joint.nq == 1 else [np.cos(angle), np.sin(angle)]
            configuration[joint.idx_q : joint.idx_q + joint.nq] = value
        pinocchio.framesForwardKinematics(original, data, configuration)
        for limb, foot in zip(robot.limbs, robot.foot_positions(np.zeros(6), q), strict=True):
            frame = original.getFrameId(limb.foot.link, pinocchio.FrameType.BODY)
            assert foot == pytest.approx(data.oMf[frame].act(np.array(limb.foot.offset)), abs=1e-9)


def test_it_stands_on_all_feet_and_can_hold_each_of_them_up(found) -> None:
    robot, *_ = found
    base = np.array([0.0, 0.0, robot.nominal.body_height, 0.0, 0.0, 0.0])
    radii = np.array([x.foot.radius for x in robot.limbs])
    assert np.abs(robot.foot_positions(base, robot.nominal.posture)[:, 2] - radii).max() < 2e-3
    assert (robot.foot_positions(base, robot.nominal.held_posture)[:, 2] - radii > 0.08).all()
    for posture in (robot.nominal.posture, robot.nominal.held_posture):
        assert (posture >= robot.lower - 1e-9).all()
        assert (posture <= robot.upper + 1e-9).all()


def test_an_arm_is_no_limb_and_its_joints_come_last() -> None:
    robot = load_robot(example("anymal_b_simple_description/robots/anymal-kinova.urdf"))
    legs = [j for x in robot.limbs for j in x.joints]
    assert list(robot.joint_names[: len(legs)]) == legs
    assert all(j.startswith("j2s6s200") for j in robot.joint_names[len(legs) :])
    assert len(robot.joint_names) == 18


def test_a_robot_without_recognisable_feet_asks_for_them() -> None:
    (problem,) = problems(bullet("cube.urdf"))
    assert problem.key == "feet"
    assert "link, offset, radius" in problem.expected


def test_a_file_whose_joints_have_no_effort_is_refused_joint_by_joint() -> None:
    found = problems(bullet("mini_cheetah/mini_cheetah.urdf"))
    assert len(found) == 24
    assert {"effort 0 N m", "velocity 0 rad/s"} == {p.found for p in found}


def beside(folder: Path, urdf: Path, text: str) -> Path:
    path = folder / "robot.yaml"
    path.write_text(f"format: 1\nname: mine\nurdf: {urdf}\n{text}", encoding="utf-8")
    return path


def test_a_yaml_beside_the_urdf_gives_limits_and_feet(tmp_path: Path) -> None:
    text = """joints: {all: {effort: 18, velocity: 30}}
feet:
  - {link: shank_fl, offset: [0, 0, -0.18], radius: 0.02}
  - {link: toe_fr, radius: 0.015}
  - {link: toe_hl, radius: 0.015}
  - {link: toe_hr, radius: 0.015, limb: R2}
nominal:
  speed: 0.1
  gait: wave
"""
    robot = load_robot(beside(tmp_path, bullet("mini_cheetah/mini_cheetah.urdf"), text))
    assert robot.name == "mine"
    assert set(robot.effort) == {18.0}
    assert robot.nominal.speed == 0.1
    assert robot.limb("L1").foot.radius == 0.02
    toe = robot.limb("R2").foot
    assert (toe.link, toe.radius) == ("shank_hr", 0.015), "a foot on a merged link moves to the one it is part of"
    assert np.linalg.norm(toe.offset) == pytest.approx(0.18, abs=0.03)


def test_sides_and_names_can_be_overruled(tmp_path: Path) -> None:
    feet = [f"  - {{link: {x}_calf, offset: [0, 0, -0.2], radius: 0.02}}" for x in ("FL", "FR", "RL")]
    feet.append("  - {link: RR_calf, offset: [0, 0, -0.2], radius: 0.02, side: middle, limb: M1}")
    path = beside(tmp_path, example("a1_description/urdf/a1.urdf"), "feet:\n" + "\n".join(feet) + "\n")
    assert load_robot(path).limb_names == ("L1", "L2", "R1", "M1")


@pytest.mark.parametrize(
    ("text", "key", "expected"),
    [
        ("feet: [{link: FL_clf, radius: 0.02}]", "feet[0].link", "FL_calf"),
        ("feet: [{link: FL_calf}]", "feet[0].radius", "a number > 0"),
        ("feet: [{link: base, radius: 0.02}]", "feet[0].link", "a link that joints carry"),
        ("feet: [{link: FL_calf, radius: 0.02}, {link: FL_thigh, radius: 0.02}]", "feet", "meet in the base alone"),
        ("feet: [{link: FL_calf, radius: 0.02, limb: R1}]", "limbs: R1", "L1"),
        ("joints: {FL_knee: {effort: 3}}", "joints.FL_knee", "FL_hip_joint"),
        ("chassis: box", "chassis", "urdf"),
    ],
)
def test_a_bad_yaml_beside_a_urdf_is_refused(tmp_path: Path, text: str, key: str, expected: str) -> None:
    path = beside(tmp_path, example("a1_description/urdf/a1.urdf"), text + "\n")
    assert any(p.key == key and expected in p.expected for p in problems(path)), problems(path)


def test_a_urdf_that_is_not_there_is_refused(tmp_path: Path) -> None:
    assert problems(beside(tmp_path, Path("nowhere.urdf"), ""))[0].key == "urdf"


def test_a_file_that_is_no_urdf_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "robot.urdf"
    path.write_text("not xml", encoding="utf-8")
    assert problems(path)[0].expected == "a URDF file"


LEG = """<link name="{n}"><inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/>
</inertial><collision><origin xyz="0 0 -0.2"/><geometry><sphere radius="0.02"/></geometry></collision></link>
<joint name="{n}_j" type="revolute"><parent link="base"/><child link="{n}"/><origin xyz="{x} {y} 0"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" effort="5" velocity="2"/></joint>"""
BODY = """<link name="base"><inertial><mass value="3"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/>
</inertial></link>"""


def spider(folder: Path, places: dict[str, tuple[float, float]], text: str = "", head: str = "") -> Path:
    """A robot of one-joint legs, for what only its geometry can tell."""
    legs = "".join(LEG.format(n=n, x=x, y=y) for n, (x, y) in places.items())
    path = folder / "spider.urdf"
    path.write_text(f"<?xml version='1.0'?>\n<robot name='spider'>{BODY}{legs}{head}{text}</robot>", encoding="utf-8")
    return path


FIVE = {"c": (0.0, 0.2), "a": (0.3, -0.2), "tail": (-0.3, 0.004), "b": (0.3, 0.2), "d": (0.0, -0.2)}


def test_a_limb_on_the_midline_belongs_to_neither_side(tmp_path: Path) -> None:
    robot = load_robot(spider(tmp_path, FIVE))
    assert {x.name: x.foot.link for x in robot.limbs} == {"L1": "b", "L2": "c", "R1": "a", "R2": "d", "M1": "tail"}
    assert robot.limb("M1").side == "middle"


def test_order_in_the_file_does_not_matter(tmp_path: Path) -> None:
    (tmp_path / "other").mkdir()
    one, other = spider(tmp_path, FIVE), spider(tmp_path / "other", dict(reversed(FIVE.items())))
    names = [{x.name: x.foot.link for x in load_robot(p).limbs} for p in (one, other)]
    assert names[0] == names[1]


def test_a_head_that_never_reaches_the_ground_is_no_limb(tmp_path: Path) -> None:
    head = LEG.format(n="head", x=0.4, y=0.0).replace("0 0 -0.2", "0 0 0.1")
    robot = load_robot(spider(tmp_path, FIVE, head=head))
    assert "head" not in {x.foot.link for x in robot.limbs}
    assert robot.joint_names[-1] == "head_j"
    assert any("head" in w and "ground" in w for w in robot.warnings)


@pytest.mark.parametrize(
    ("old", "new", "key", "words"),
    [
        ('<mass value="1"/>', '<mass value="0"/>', "link a", "a mass of 0 kg"),
        ('ixx="0.01" iyy="0.01"', 'ixx="0.01" iyy="-0.01"', "link a", "not positive definite"),
        ('lower="-1"', 'lower="2"', "joint a_j", "lower 2, upper 1"),
        ('effort="5"', "", "joint a_j", "effort 0"),
        ('velocity="2"', 'velocity="-2"', "joint a_j", "velocity -2"),
        ('type="revolute"', 'type="prismatic"', "joint a_j", "type prismatic"),
        ('xyz="0 1 0"', 'xyz="0 0 0"', "joint a_j", "axis of length 0"),
        ('parent link="base"', 'parent link="bass"', "joint a_j", "'bass'"),
        ('link name="a"', 'link name="b"', "link b", "2 links"),
        ('joint name="a_j"', 'joint name="b_j"', "joint b_j", "2 joints"),
    ],
)  # fmt: skip
def test_a_urdf_that_would_fall_over_quietly_is_refused(
    tmp_path: Path, old: str, new: str, key: str, words: str
) -> None:
    path = spider(tmp_path, FIVE)
    start = 'link name="a"'
    head, leg = path.read_text(encoding="utf-8").split(start)
    leg = (start + leg).replace(old, new, 1)
    path.write_text(head + leg, encoding="utf-8")
    found = problems(path)
    assert any(p.key == key and words in p.found for p in found), found


def test_what_can_be_mended_is_mended_and_said(tmp_path: Path) -> None:
    path = spider(tmp_path, FIVE)
    text = path.read_text(encoding="utf-8").replace('xyz="0 1 0"', 'xyz="0 2 0"', 1)
    mesh = '<visual><geometry><mesh filename="package://gone/x.stl"/></geometry></visual></link>'
    path.write_text(text.replace("</link>", mesh, 1), encoding="utf-8")
    robot = load_robot(path)
    assert any("normalised" in w for w in robot.warnings)
    assert any("x.stl" in w and "left out" in w for w in robot.warnings)
    assert "x.stl" not in robot.urdf


def test_pybullet_loads_what_was_made_of_a_file_of_others(tmp_path: Path, found) -> None:
    import pybullet as p

    robot, *_ = found
    file = tmp_path / "robot.urdf"
    file.write_text(robot.urdf, encoding="utf-8")
    client = p.connect(p.DIRECT)
    body = p.loadURDF(str(file), flags=p.URDF_USE_INERTIA_FROM_FILE, physicsClientId=client)
    count = p.getNumJoints(body, physicsClientId=client)
    masses = [p.getDynamicsInfo(body, i, physicsClientId=client)[0] for i in range(-1, count)]
    p.disconnect(client)
    assert count == len(robot.joint_names)
    assert sum(masses) == pytest.approx(robot.mass, abs=1e-9)
