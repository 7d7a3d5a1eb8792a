"""Limbs that fail during a phase, as data."""

from __future__ import annotations

from typing import Any

import pytest

from gaitforge.errors import InputError
from gaitforge.robot.load import load_robot
from gaitforge.robot.model import RobotModel
from gaitforge.task.load import load_task
from gaitforge.task.phase import Failure
from gaitforge.task.roles import Failed


@pytest.fixture(scope="module")
def dodecapod() -> RobotModel:
    return load_robot("dodecapod")


def task(**more: Any) -> dict[str, Any]:
    first = {"name": "all", "failure": more.pop("failure", {}), **more.pop("first", {})}
    return {"phases": [first, {"name": "without", **more.pop("then", {})}], **more}


def problems(data: dict[str, Any], robot: RobotModel) -> dict[str, str]:
    with pytest.raises(InputError) as caught:
        load_task(data, "t", robot=robot, file="t.yaml")
    return {p.key: p.found for p in caught.value.problems}


def test_what_a_failure_leaves_open_the_task_says_once(dodecapod: RobotModel) -> None:
    found = load_task(task(limbs=["camera", "L3"], mode="limp"), "t", robot=dodecapod)
    assert found.phases[0].failure == Failure(("R2", "L3"), "limp", None)
    assert found.phases[1].failure is None
    own = load_task(task(limbs=["L3"], mode="limp", failure={"mode": "locked", "at": 0.25}), "t", robot=dodecapod)
    assert own.phases[0].failure == Failure(("L3",), "locked", 0.25)


def test_a_failed_limb_may_be_limp_and_have_a_posture(dodecapod: RobotModel) -> None:
    roles = {"L3": {"role": "failed", "mode": "limp", "posture": [0.1, 0.2, 0.3]}, "L4": "failed"}
    (phase,) = load_task({"phases": [{"name": "a", "roles": roles}]}, "t", robot=dodecapod).phases
    assert phase.roles == {"L3": Failed("limp", (0.1, 0.2, 0.3)), "L4": Failed("locked", None)}


@pytest.mark.parametrize(
    ("data", "key", "found"),
    [
        (task(), "phases.0.failure.limbs", "none"),
        (task(limbs=[]), "limbs", "none"),
        (task(limbs=["L9"]), "limbs", "'L9'"),
        (task(limbs=["R2", "camera"]), "limbs", "'R2' twice"),
        (task(limbs=["L1"], mode="broken"), "mode", "'broken'"),
        (task(limbs=["L1"], at=1.0), "at", "1.0"),
        (task(limbs=["L1"], failure={"when": 3}), "phases.0.failure.when", "an unknown key"),
        (task(limbs=["L1"], first={"roles": {"L1": "held"}}), "phases.0.failure.limbs", "'L1'"),
        (task(limbs=["L1"], then={"roles": {"L1": "held"}}), "phases.1.roles.L1", "a limb that has failed before"),
        (task(limbs=["L1"], then={"failure": {}}), "phases.1.failure.limbs", "'L1'"),
        (task(limbs=["L1"], then={"failure": {"limbs": ["L2"]}}), "phases.1.failure", "the last phase"),
    ],
)
def test_a_failure_that_makes_no_sense_is_refused(
    dodecapod: RobotModel, data: dict[str, Any], key: str, found: str
) -> None:
    assert problems(data, dodecapod)[key] == found
