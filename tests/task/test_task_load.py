"""Plain data → `Task`."""

from __future__ import annotations

from typing import Any

import pytest

from gaitforge.errors import InputError
from gaitforge.robot.load import load_robot
from gaitforge.robot.model import RobotModel
from gaitforge.task.load import load_task
from gaitforge.task.roles import Failed, Held, Locomotive, Tool

PIPE = {"name": "pipe", "kind": "pipe", "pose": {"xyz": [2.5, 0.0, 0.3], "rpy": [0, 0, 0]}, "radius": 0.1}


@pytest.fixture(scope="module")
def dodecapod() -> RobotModel:
    return load_robot("dodecapod")


def problems(data: dict[str, Any], robot: RobotModel | None = None) -> list[tuple[str, str]]:
    with pytest.raises(InputError) as caught:
        load_task(data, "t", robot=robot, file="t.yaml")
    assert all(p.file == "t.yaml" for p in caught.value.problems)
    return [(p.key, p.found) for p in caught.value.problems]


def test_a_task_is_phases_and_a_scene(dodecapod: RobotModel) -> None:
    roles = {"camera": {"role": "tool", "look_at": "pipe.opening"}, "L6": "failed", "R6": "locomotive", "L1": "held"}
    data = {"scene": [PIPE], "phases": [{"name": "all", "cycles": 3}, {"name": "inspect", "roles": roles}]}
    task = load_task(data, "t", robot=dodecapod)
    assert [(p.name, p.cycles) for p in task.phases] == [("all", 3), ("inspect", 2)]
    assert task.phases[1].roles == {
        "camera": Tool("pipe.opening"), "L6": Failed(), "R6": Locomotive(), "L1": Held(),
    }  # fmt: skip
    assert task.scene.point("pipe.opening").tolist() == [2.5, 0.0, 0.3]


def test_what_a_task_says_once_holds_for_phases_that_say_nothing() -> None:
    data = {"speed": 0.05, "gait": "wave", "phases": [{"name": "a"}, {"name": "b", "speed": 0.08, "gait": None}]}
    one, other = load_task(data, "t").phases
    assert (one.speed, one.gait) == (0.05, "wave")
    assert (other.speed, other.gait) == (0.08, "wave")


def test_phases_may_be_given_by_name() -> None:
    task = load_task({"phases": {"first": {"cycles": 1}, "second": {"cycles": 2}}}, "t")
    assert [(p.name, p.cycles) for p in task.phases] == [("first", 1), ("second", 2)]


def test_a_hand_written_pattern_covers_every_limb() -> None:
    robot = load_robot("quadruped")
    rows = {"L1": "0111", "L2": "1011", "R1": [1, 1, 0, 1], "R2": "1110"}
    task = load_task({"phases": [{"name": "a", "gait": rows}]}, "t", robot=robot)
    assert task.phases[0].gait == {"L1": "0111", "L2": "1011", "R1": "1101", "R2": "1110"}
    wrong = {"L1": "0121", "L2": "10", "R1": "1101", "X": "1110"}
    found = problems({"phases": [{"name": "a", "gait": wrong}]}, robot)
    keys = [key for key, _ in found]
    assert keys.count("phases.0.gait") == 2  # lengths differ; R2 has no row
    assert {"phases.0.gait.L1", "phases.0.gait.X"} <= set(keys)


def test_a_hand_written_pattern_agrees_with_the_roles() -> None:
    robot = load_robot("hexapod")
    rows = dict.fromkeys(robot.limb_names, "0111") | {"L2": "0000"}
    found = problems({"phases": [{"name": "a", "gait": rows, "roles": {"R1": "held"}}]}, robot)
    assert [key for key, _ in found] == ["phases.0.gait.L2", "phases.0.gait.R1"]


def test_all_problems_are_reported_together(dodecapod: RobotModel) -> None:
    data = {
        "sped": 1,
        "scene": [PIPE, {**PIPE, "radius": -1}, {"name": "b", "kind": "sphere", "mas": 1}],
        "phases": [
            {"name": "a", "cycles": 0, "speed": float("nan"), "roles": {"R9": "held", "R1": "idle"}},
            {"name": "a", "kind": "fly", "roles": {"R3": {"role": "tool", "look_at": [1, 0]}}},
            {"name": "start", "roles": {"camera": {"role": "tool", "look_at": "pipe.closing"}, "R2": "held"}},
        ],
    }
    assert {key for key, _ in problems(data, dodecapod)} == {
        "sped", "scene", "scene.1.radius", "scene.2.kind", "scene.2.mas",
        "phases", "phases.0.cycles", "phases.0.speed", "phases.0.roles.R9", "phases.0.roles.R1.role",
        "phases.1.kind", "phases.1.roles.R3", "phases.1.roles.R3.look_at",
        "phases.2.roles", "phases.2.roles.camera.look_at",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("data", "key"),
    [
        ({}, "phases"),
        ({"phases": []}, "phases"),
        ({"phases": "walk"}, "phases"),
        ({"phases": [{"cycles": 2}]}, "phases.0.name"),
        ({"phases": [{"name": "a/b"}]}, "phases.0.name"),
        ({"phases": [{"name": "a", "cycles": 1.5}]}, "phases.0.cycles"),
        ({"phases": [{"name": "a", "cycles": True}]}, "phases.0.cycles"),
        ({"phases": [{"name": "a", "duration": 0}]}, "phases.0.duration"),
        ({"phases": [{"name": "a", "gait": "gallop"}]}, "phases.0.gait"),
        ({"phases": [{"name": "a"}], "gait": "gallop"}, "gait"),
        ({"phases": [{"name": "a", "roles": {"R1": {"role": "held", "posture": "up"}}}]}, "phases.0.roles.R1.posture"),
    ],
)
def test_a_wrong_value_is_named_by_its_key(data: dict[str, Any], key: str) -> None:
    assert key in [found for found, _ in problems(data)]


def test_a_limb_has_one_role_even_when_it_is_named_by_its_tool(dodecapod: RobotModel) -> None:
    carrier = next(t.limb for t in dodecapod.tools if t.name == "camera")
    found = problems({"phases": [{"name": "a", "roles": {"camera": "held", carrier: "failed"}}]}, dodecapod)
    assert found == [("phases.0.roles", f"'{carrier}' twice")]


def test_a_held_posture_has_a_position_for_every_joint(dodecapod: RobotModel) -> None:
    held = {"role": "held", "posture": [0.1, 0.2]}
    found = problems({"phases": [{"name": "a", "roles": {"R1": held}}]}, dodecapod)
    assert found == [("phases.0.roles.R1.posture", "2 values")]


def test_a_phase_says_what_is_carried(dodecapod: RobotModel) -> None:
    box = {"mass": 0.5, "point": [0.3, 0.0, 0.1]}
    data = {"loads": [box], "phases": [{"name": "a"}, {"name": "b", "loads": [{**box, "frame": "gripper_L1"}]}]}
    one, other = load_task(data, "t", robot=dodecapod).phases
    assert (one.loads[0].mass, one.loads[0].frame) == (0.5, "body")
    assert (other.loads[0].point, other.loads[0].frame) == ((0.3, 0.0, 0.1), "gripper_L1")


def test_a_wrong_load_is_refused(dodecapod: RobotModel) -> None:
    loads = [{"mass": 0.0, "point": [0, 0]}, {"mass": 1.0, "point": [0, 0, 0], "frame": "L9", "weight": 3}]
    found = problems({"phases": [{"name": "a", "loads": loads}]}, dodecapod)
    keys = ("0.mass", "0.point", "1.weight", "1.frame")
    assert [key for key, _ in found] == [f"phases.0.loads.{key}" for key in keys]


def test_a_phase_commands_body_steps_posture_and_duration(dodecapod: RobotModel) -> None:
    given = {"body_height": 0.15, "roll": 0.05, "pitch": -0.1, "step_height": 0.05, "duration": "auto",
             "posture": {"L1": [0.4, 0, 0]}}  # fmt: skip
    (phase,) = load_task({"phases": [{"name": "a", **given}]}, "t", robot=dodecapod).phases
    assert (phase.body_height, phase.roll, phase.pitch) == (0.15, 0.05, -0.1)
    assert (phase.step_height, phase.duration, phase.posture) == (0.05, "auto", {"L1": (0.4, 0.0, 0.0)})
    plain = load_task({"phases": [{"name": "a"}]}, "t", robot=dodecapod).phases[0]
    assert (plain.body_height, plain.roll, plain.pitch, plain.posture, plain.duration) == (None, 0.0, 0.0, None, None)


@pytest.mark.parametrize(
    ("given", "key"),
    [
        ({"body_height": -0.1}, "body_height"), ({"roll": 0.7}, "roll"), ({"step_height": 0.0}, "step_height"),
        ({"duration": "short"}, "duration"), ({"posture": "upright"}, "posture"),
        ({"posture": {"L9": [0, 0, 0]}}, "posture.L9"), ({"posture": {"L1": [0, 0]}}, "posture.L1"),
        ({"posture": {"L1": [0, 0, 2.0]}}, "posture.L1"),
    ],
)  # fmt: skip
def test_a_wrong_command_is_refused(given: dict[str, Any], key: str, dodecapod: RobotModel) -> None:
    assert [found for found, _ in problems({"phases": [{"name": "a", **given}]}, dodecapod)] == [f"phases.0.{key}"]
