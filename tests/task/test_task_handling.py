"""Phases that pick up and put down, out of plain data."""

from __future__ import annotations

from typing import Any

import pytest

from gaitforge.errors import InputError
from gaitforge.pipeline.handling import blocks
from gaitforge.robot.load import load_robot
from gaitforge.robot.model import RobotModel
from gaitforge.task.handling import Pick, Place
from gaitforge.task.load import load_task

BOX = {"name": "box", "kind": "box", "size": [0.1, 0.2, 0.1], "mass": 0.5}
SHELF = {"name": "shelf", "kind": "box", "size": [0.1, 0.2, 0.1]}
PICK = {"name": "take", "kind": "pick", "object": "box", "limbs": ["L1", "R1"]}
WALK = {"name": "walk"}
PLACE = {"name": "put", "kind": "place", "object": "box"}


@pytest.fixture(scope="module")
def hexapod() -> RobotModel:
    return load_robot("hexapod")


def test_a_task_picks_up_walks_and_puts_down(hexapod: RobotModel) -> None:
    phases = [{**PICK, "squeeze": 12.0, "lift": None}, WALK, {**PLACE, "onto": "shelf"}]
    task = load_task({"scene": [BOX, SHELF], "phases": phases, "cycles": 3}, "t", robot=hexapod)
    assert [p.kind for p in task.phases] == ["pick", "walk", "place"]
    assert task.phases[0].handling == Pick("box", ("L1", "R1"), squeeze=12.0)
    assert task.phases[2].handling == Place("box", "shelf")
    assert task.phases[1].cycles == 3


def test_a_task_may_pick_up_another_box_when_it_has_put_one_down(hexapod: RobotModel) -> None:
    tray = {**BOX, "name": "tray"}
    again = [{**PICK, "name": "again", "object": "tray"}, {**WALK, "name": "on"}]
    phases = [PICK, WALK, PLACE, *again]
    task = load_task({"scene": [BOX, tray], "phases": phases}, "t", robot=hexapod)
    assert [[p.name for p in part.phases] for part in blocks(task)] == [
        ["take", "walk", "put"], ["again", "on"],
    ]  # fmt: skip
    assert all(part.scene == task.scene for part in blocks(task))


def test_who_holds_a_box_picks_up_no_other_after_a_walk(hexapod: RobotModel) -> None:
    tray = {**BOX, "name": "tray"}
    again = {**PICK, "name": "again", "object": "tray", "limbs": ["L2", "R2"]}
    with pytest.raises(InputError) as caught:
        load_task({"scene": [BOX, tray], "phases": [PICK, WALK, again, {**WALK, "name": "on"}]}, "t", robot=hexapod)
    (problem,) = caught.value.problems
    assert (problem.key, problem.found) == ("phases.2.object", "tray while box is held")


@pytest.mark.parametrize(
    ("phases", "key"),
    [
        ([{**PICK, "object": "shelf"}, WALK], "phases.0.object"),
        ([{**PICK, "object": "sofa"}, WALK], "phases.0.object"),
        ([{**PICK, "limbs": ["L1", "L2"]}, WALK], "phases.0.limbs"),
        ([{**PICK, "limbs": ["L1", "gripper_L1"]}, WALK], "phases.0.limbs"),
        ([{**PICK, "limbs": ["L1", "R9"]}, WALK], "phases.0.limbs"),
        ([{**PICK, "limbs": None}, WALK], "phases.0.limbs"),
        ([{**PICK, "grasp": "glue"}, WALK], "phases.0.grasp"),
        ([{**PICK, "squeeze": 0}, WALK], "phases.0.squeeze"),
        ([{**PICK, "speed": 0.1}, WALK], "phases.0.speed"),
        ([{**PICK, "onto": "ground"}, WALK], "phases.0.onto"),
        ([WALK, PICK], "phases"),
        ([PICK, PLACE], "phases"),
        ([PICK, {**WALK, "roles": {"L1": "held"}}], "phases.1.roles.L1"),
        ([PICK, {**WALK, "lift": 0.1}], "phases.1.lift"),
        ([WALK, PLACE], "phases.1.object"),
        ([PICK, WALK, {**PLACE, "onto": "cloud"}], "phases.2.onto"),
        ([PICK, {**PICK, "name": "again"}, WALK], "phases.1.limbs"),
    ],
)
def test_a_task_that_cannot_be_meant_is_refused(phases: list[dict[str, Any]], key: str, hexapod: RobotModel) -> None:
    with pytest.raises(InputError) as caught:
        load_task({"scene": [BOX, SHELF], "phases": phases}, "t", robot=hexapod, file="t.yaml")
    assert key in [problem.key for problem in caught.value.problems]
