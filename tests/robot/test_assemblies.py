"""What an assembly may say: parameters, mirrored limbs, tools, folders of one's own."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from kit import changed, shipped, write_robot

from gaitforge import resources
from gaitforge.errors import InputError
from gaitforge.robot.load import load_robot
from gaitforge.robot.module_read import load_module
from gaitforge.robot.read import Section, load_yaml


def test_a_parameter_lengthens_the_limb_and_adds_its_mass(tmp_path: Path) -> None:
    longer = load_robot(write_robot(tmp_path, "quadruped", ("tube_inline, length: 0.23", "tube_inline, length: 0.33")))
    robot = load_robot("quadruped")
    assert longer.mass - robot.mass == pytest.approx(4 * 0.4 * 0.1, abs=1e-9)
    assert longer.nominal.body_height - robot.nominal.body_height == pytest.approx(0.1 * np.cos(0.35), abs=1e-9)


def test_a_mirrored_limb_is_the_mirror_image_with_the_signs_of_its_angles_turned() -> None:
    robot = load_robot("quadruped")
    q = np.zeros(12)
    for name, angles in (("L1", [0.3, -0.4, 0.9]), ("R1", [-0.3, 0.4, -0.9])):
        q[robot.joint_indices(robot.limb(name))] = angles
    feet = dict(zip(robot.limb_names, robot.foot_positions(np.zeros(6), q), strict=True))
    assert feet["R1"] == pytest.approx(feet["L1"] * [1.0, -1.0, 1.0], abs=1e-12)
    left, right = (robot.joint_indices(robot.limb(x)) for x in ("L1", "R1"))
    assert (robot.lower[right] == -robot.upper[left]).all()
    assert (robot.upper[right] == -robot.lower[left]).all()


def test_a_clocked_module_is_turned_about_its_port(tmp_path: Path) -> None:
    chain = "chain: [joint, joint, extension, joint, elbow_foot]"
    turned = "chain: [joint, joint, extension, joint, {module: elbow_foot, clock: 3.141592653589793}]"
    robot = load_robot(write_robot(tmp_path, "hexapod", (chain, turned)))
    foot = robot.foot_positions(np.zeros(6), np.zeros(20))[1]
    assert foot == pytest.approx([0.0, 0.3787, 0.0381 + 0.146], abs=1e-9), "the elbow points up instead of down"


def test_tools_can_sit_on_any_limb_and_are_named_after_it_when_there_are_several(tmp_path: Path) -> None:
    pair = ("tools: {L1: gripper, R1: gripper}", "tools: {L2: gripper, R3: [camera_mount, camera]}")
    robot = load_robot(write_robot(tmp_path, "hexapod", pair))
    assert {(t.name, t.limb) for t in robot.tools} == {("gripper", "L2"), ("camera", "R3")}
    assert robot.limb("gripper").name == "L2"
    assert robot.limb("L2").tool_joints == ("L2_gripper",)
    assert robot.modules == 19


def test_a_held_posture_is_found_for_limbs_that_have_none(tmp_path: Path) -> None:
    text = shipped("hexapod")
    block = text[text.index("  held_posture") : text.index("  speed")]
    robot = load_robot(write_robot(tmp_path, "hexapod", (block, "")))
    base = [0.0, 0.0, robot.nominal.body_height, 0.0, 0.0, 0.0]
    feet = robot.foot_positions(base, robot.nominal.held_posture)
    assert (feet[:, 2] - 0.0254 >= 0.08).all()


def test_a_foot_may_be_given_by_hand(tmp_path: Path) -> None:
    path = write_robot(tmp_path)
    with path.open("a", encoding="utf-8") as file:
        file.write("feet: [{link: L1_link3, offset: [0.0445, -0.15, 0.0], radius: 0.02}]\n")
    with pytest.raises(InputError, match="all feet on the ground"):
        load_robot(path)  # that foot is somewhere else, and a stand on it is refused
    text = path.read_text(encoding="utf-8").replace("offset: [0.0445, -0.15, 0.0], radius: 0.02",
                                                    "offset: [-0.146, 0.0, 0.0718], radius: 0.0254")  # fmt: skip
    path.write_text(text.replace("L1_link3", "R2_link3"), encoding="utf-8")
    given, recognised = load_robot(path), load_robot("hexapod")
    posture = recognised.nominal.held_posture
    feet = [r.foot_positions(np.zeros(6), posture) for r in (given, recognised)]
    assert feet[0] == pytest.approx(feet[1], abs=1e-9), "the published foot, given by hand"


def test_users_folders_come_before_the_shipped_ones(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    mine, work = tmp_path / "mine", tmp_path / "work"
    for folder, speed in ((mine / "hexapod", "0.05"), (work / "robots" / "crawler", "0.04")):
        folder.mkdir(parents=True)
        text = changed(shipped("hexapod"), ("speed: 0.064", f"speed: {speed}"))
        (folder / "robot.yaml").write_text(text, encoding="utf-8")
    monkeypatch.chdir(work)
    monkeypatch.setenv("GAITFORGE_ROBOTS", os.pathsep.join([str(mine), str(tmp_path / "nowhere")]))
    assert {"crawler", "dodecapod", "hexapod", "quadruped"} <= set(resources.robot_files())
    assert load_robot("hexapod").nominal.speed == 0.05
    assert load_robot("crawler").nominal.speed == 0.04
    assert load_robot(work / "robots" / "crawler").name == "crawler"


def test_configuration_and_robots_are_found_from_any_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert (resources.conf_dir() / "config.yaml").is_file()
    assert set(resources.module_dirs()) >= {"cmu_sea", "hebi"}


def test_yaml_means_what_people_expect(tmp_path: Path) -> None:
    path = tmp_path / "x.yaml"
    path.write_text("a: 1e-4\nb: 1.5E3\non: 2\nno: 3\nc: true\n", encoding="utf-8")
    assert load_yaml(path) == {"a": 1e-4, "b": 1500.0, "on": 2, "no": 3, "c": True}


def test_a_number_may_depend_on_parameters() -> None:
    s = Section({"a": "length", "b": {"base": 0.2, "length": 0.5}, "c": "width"}, "f", values={"length": 2.0})
    assert (s.number("a"), s.number("b")) == (2.0, 1.2)
    s.number("c", "m")
    assert [p.key for p in s.problems] == ["c"]


def test_a_mesh_module_needs_its_mesh(tmp_path: Path) -> None:
    extension = resources.module_dirs()["cmu_sea"] / "extension.yaml"
    mesh = "{mesh: {file: tube.stl}, xyz"
    text = changed(extension.read_text(encoding="utf-8"), ("{cylinder: {radius: 0.0254, length: length}, xyz", mesh))
    path = tmp_path / "extension.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        load_module(path)
    keys = {p.key for p in caught.value.problems}
    assert keys == {"bodies.body.shapes[0].mesh.file", "bodies.body.inertia"}, "no mesh, and no volume for the mass"
