"""Every kind of bad input is refused with file, key, what was found and what was expected."""

from __future__ import annotations

from pathlib import Path

import pytest
from kit import problems, write_robot

from gaitforge.errors import InputError
from gaitforge.robot.load import load_robot

LEG = "chain: [joint, joint, extension, joint, elbow_foot]"
UNCLOCKED = "xyz: [0, 0, 0.0273]\n    rpy: [0, 0, -1.5707963267948966]\n    clocking: [0, 1.5707963267948966,"

# what is changed in hexapod's robot.yaml → key of the complaint, words in what was found, words in what was expected
ROBOT_CASES = {
    "a misspelt key": ([("chassis:", "chasis:")], "chasis", "unknown key", "did you mean 'chassis'"),
    "a misspelt nominal key": ([("  speed:", "  sped:")], "nominal.sped", "unknown key", "did you mean 'speed'"),
    "an unknown module": ([("extension,", "extention,")], "limbs.leg.chain[2]", "'extention'", "extension"),
    "an unknown chassis": ([("chassis: hexapod_body", "chassis: x")], "chassis", "'x'", "hexapod_body"),
    "a chassis that is none": ([("chassis: hexapod_body", "chassis: joint")], "chassis", "actuator", "chassis"),
    "a tool on a limb that does not exist": ([("{L1: gripper, ", "{L9: gripper, ")], "tools.L9", "'L9'", "L1, L2, L3"),
    "a tool that is none": ([("{L1: gripper, ", "{L1: extension, ")], "tools.L1", "tube", "gripper or a camera"),
    "a posture of a limb that does not exist": (
        [("    left: [0, 0, 0]", "    L7: [0, 0, 0]")], "nominal.posture.L7", "'L7'", "L1, L2, L3",
    ),
    "a posture with too few joints": ([("right: [0, 0, 0]", "right: [0, 0]")], "nominal.posture.right", "[0, 0]", "3"),
    "a posture beyond the limits": (
        [("right: [0, 0, 0]", "right: [2, 0, 0]")], "nominal.posture.right", "2 for R1_J1", "-1.57 and 1.57",
    ),
    "a posture with feet in the air": (
        [("right: [0, 0, 0]", "right: [0, 0.5, 0]")], "nominal.posture", "R1", "all feet on the ground",
    ),
    "a port that does not exist": ([("left_3", "left_9")], "limbs.leg.mounts.L3", "'left_9'", "left_1, left_2"),
    "a port used twice": ([("left_3", "left_2")], "limbs.leg.mounts.L3", "where L2 is", "free port"),
    "a limb on the wrong side": ([("left_1,", "right_1,"), ("R1: right_1", "R1: left_1")], "limbs: R1", "R1", "L1"),
    "limbs out of order": ([("left_1,", "left_3,"), ("L3: left_3", "L3: left_1")], "limbs: L3", "L3", "L1"),
    "a limb without a name": ([("L3: left_3", "leg3: left_3")], "limbs.leg.mounts.leg3", "'leg3'", "L1, L2"),
    "a limb without a foot": ([(", elbow_foot]", ", extension]"), ("tools: {L1: gripper, R1: gripper}\n", "")],
                              "limbs.leg.mounts.L1", "tube", "foot module"),
    "the same key twice": ([("chassis: hexapod_body", "chassis: hexapod_body\nchassis: hexapod_body")], "line", "twice",
                           "each key once"),
    "another format": ([("format: 1", "format: 2")], "format", "2", "1"),
    "no format": ([("format: 1\n", "")], "format", "nothing", "1"),
    "a clock the port does not have": (
        [(LEG, "chain: [joint, {module: joint, clock: 0.5}, extension, joint, elbow_foot]")],
        "limbs.leg.chain[1]", "clock 0.5", "1.5708",
    ),
    "a parameter the module does not have": (
        [(LEG, "chain: [joint, joint, {module: extension, lenght: 0.1}, joint, elbow_foot]")],
        "parameters", "'lenght'", "length",
    ),
    "a parameter out of range": (
        [(LEG, "chain: [joint, joint, {module: extension, length: 9}, joint, elbow_foot]")],
        "parameters.length", "9", "between 0.02 and 0.3",
    ),
    "limits wider than the module's": (
        [(LEG, "chain: [{module: joint, lower: -3}, joint, extension, joint, elbow_foot]")],
        "limbs.leg.chain[0].lower", "-3", "within",
    ),
    "limits the wrong way round": (
        [(LEG, "chain: [{module: joint, lower: 1, upper: 0}, joint, extension, joint, elbow_foot]")],
        "limbs.leg.chain[0].lower", "1", "lower < upper",
    ),
    "limits on a module without a joint": (
        [(LEG, "chain: [joint, joint, {module: extension, lower: 0}, joint, elbow_foot]")],
        "limbs.leg.chain[2].lower", "limit", "no joint",
    ),
    "a handed module in a mirrored limb": (
        [("    mounts:", "    mirrored: [L1]\n    mounts:")], "limbs.leg.chain[0]", "in a mirrored limb", "mirror",
    ),
    "a mirrored limb that is not mounted": (
        [("    mounts:", "    mirrored: [L9]\n    mounts:")], "limbs.leg.mirrored", "L9", "L1, L2",
    ),
    "a gait that does not exist": ([("gait: tripod", "gait: trot")], "nominal.gait", "'trot'", "tripod, wave"),
    "a speed of nothing": ([("speed: 0.064", "speed: 0")], "nominal.speed", "0", "> 0"),
    "a number that is none": ([("duration: 2.0", "duration: soon")], "nominal.duration", "'soon'", "number"),
}  # fmt: skip

# what is changed in a module of the hexapod → the same
MODULE_CASES = {
    "a negative mass": ("extension", [("mass: 0.05 ", "mass: -0.05 ")], "bodies.body.mass", "-0.05", "≥ 0"),
    "an inertia that is not definite": (
        "joint", [("ixx: 5.48e-5, iyy: 5.48e-5", "ixx: -5.48e-5, iyy: 5.48e-5")], "bodies.input.inertia",
        "not positive", "definite",
    ),
    "an inertia against the triangle inequality": (
        "joint", [("izz: 3.48e-5", "izz: 3.48e-4")], "bodies.input.inertia", "triangle", "a + b",
    ),
    "lower above upper": ("joint", [("lower: -1.57", "lower: 1.6")], "joint.lower", "1.6", "lower < upper"),
    "an effort of nothing": ("joint", [("effort: 7.0", "effort: 0")], "joint.effort", "0", "> 0"),
    "a negative velocity": ("joint", [("velocity: 2.208932", "velocity: -1")], "joint.velocity", "-1", "> 0"),
    "a misspelt key": ("joint", [("velocity:", "velocty:")], "joint.velocty", "unknown key", "did you mean 'velocity'"),
    "an axis that is no unit vector": ("joint", [("axis: [0, 1, 0]", "axis: [0, 2, 0]")], "joint.axis", "2", "unit"),
    "a body that does not exist": ("joint", [("child: output", "child: rotor")], "joint.child", "'rotor'",
                                   "input, output"),
    "an unknown kind": ("extension", [("kind: tube", "kind: pipe")], "kind", "'pipe'", "tube"),
    "a port of another type": (
        "extension", [("in: {type: sea", "in: {type: hebi")], "limbs.leg.chain[2]", "type hebi", "type sea",
    ),
    "a port of the same gender": (
        "extension", [("in: {type: sea, gender: female", "in: {type: sea, gender: male")], "limbs.leg.chain[2]", "male",
        "female",
    ),
    "a foot module without a sphere to stand on": (
        "elbow_foot", [("foot: {xyz: [0, -0.146, 0.0445], radius: 0.0254}", "")], "foot", "nothing", "foot sphere",
    ),
    "a corner without a port for the tool": (
        "elbow_foot", [("  tool: {type: sea", "  other: {type: sea")], "tools.L1", "'tool'", "other",
    ),
    "a shape of no size": ("extension", [("radius: 0.0254", "radius: 0")], "bodies.body.shapes[0].cylinder.radius", "0",
                           "> 0"),
}  # fmt: skip


def check(found: tuple, file: str, key: str, words: str, expected: str) -> None:
    hits = [p for p in found if key in p.key]
    assert hits, found
    assert any(words in p.found and expected in p.expected for p in hits), hits
    assert all(p.file.endswith(".yaml") for p in found)
    assert any(p.file.endswith(file) for p in hits), hits


@pytest.mark.parametrize("case", ROBOT_CASES)
def test_a_bad_robot_is_refused_with_file_key_found_and_expected(case: str, tmp_path: Path) -> None:
    pairs, key, words, expected = ROBOT_CASES[case]
    file = "extension.yaml" if "parameter" in case else "robot.yaml"
    check(problems(write_robot(tmp_path, "hexapod", *pairs)), file, key, words, expected)


@pytest.mark.parametrize("case", MODULE_CASES)
def test_a_bad_module_is_refused_with_file_key_found_and_expected(case: str, tmp_path: Path) -> None:
    module, pairs, key, words, expected = MODULE_CASES[case]
    file = "robot.yaml" if key.startswith(("limbs", "tools")) else f"{module}.yaml"
    check(problems(write_robot(tmp_path, "hexapod", modules={module: pairs})), file, key, words, expected)


def test_the_unchanged_copy_is_accepted(tmp_path: Path) -> None:
    assert load_robot(write_robot(tmp_path / "hexapod")).urdf == load_robot("hexapod").urdf


def test_all_problems_of_a_file_are_reported_together(tmp_path: Path) -> None:
    path = write_robot(tmp_path, "hexapod", ("speed: 0.064", "speed: -1"), ("gait: tripod", "gait: hop"),
                       ("columns: 12 ", "columns: 1.5 "))  # fmt: skip
    assert {p.key for p in problems(path)} == {"nominal.speed", "nominal.gait", "nominal.columns"}
    module = [("effort: 7.0", "effort: -7"), ("velocity: 2.208932", "velocty: 2"), ("gender: male", "gender: odd")]
    found = problems(write_robot(tmp_path / "two", modules={"joint": module}))
    assert {"joint.effort", "joint.velocty", "joint.velocity", "ports.out.gender"} <= {p.key for p in found}


def test_an_unknown_robot_is_answered_with_the_names_there_are() -> None:
    with pytest.raises(InputError) as caught:
        load_robot("hexapodd")
    (problem,) = caught.value.problems
    assert "hexapodd" in problem.found
    assert all(name in problem.expected for name in ("dodecapod", "hexapod", "quadruped"))


def test_a_file_that_is_no_yaml_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text("limbs: [1, 2", encoding="utf-8")
    assert problems(path)[0].file == str(path)
    path.write_text("- a list", encoding="utf-8")
    assert problems(path)[0].found == "list"
