"""Robots that cannot walk as asked: exit code 3 with the reason, and a summary that says the same."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

from tests.conftest import Finished

Run = Callable[..., Finished]


def summary_of(finished: Finished) -> dict[str, Any]:
    """The one summary that was left."""
    (file,) = finished.folder.rglob("summary.json")
    return json.loads(file.read_text())


def test_fewer_than_four_locomotive_limbs_never_walk(gaitforge: Run) -> None:
    finished = gaitforge("robot=quadruped", "+task.phases.0.roles.L1=held")
    assert finished.code == 3
    assert "Traceback" not in finished.err
    summary = summary_of(finished)
    assert summary["status"] == "infeasible"
    assert {"g5", "g8"} <= set(summary["explain"]["families"])
    assert "infeasible" in finished.out


def test_two_lost_left_limbs_are_explained_in_words_as_data_and_as_a_picture(gaitforge: Run) -> None:
    finished = gaitforge("robot=hexapod", "+task.phases.0.roles.L1=held", "+task.phases.0.roles.L2=held")
    assert finished.code == 3
    explain = summary_of(finished)["explain"]
    assert explain["families"] == ["g5", "g9"]
    assert explain["limbs"] == ["L3"]
    assert explain["text"] in finished.out
    assert "left limb" in explain["advice"]
    (picture,) = finished.folder.rglob("clash.png")
    assert picture.read_bytes().startswith(b"\x89PNG")
    (page,) = finished.folder.rglob("report.html")
    assert "What clashes" in page.read_text()


def test_a_speed_that_no_joint_can_follow_is_infeasible_with_the_reason(gaitforge: Run) -> None:
    finished = gaitforge("robot=hexapod", "task.speed=2.0")
    assert finished.code == 3
    assert "2 m/s is impossible" in finished.out
    summary = summary_of(finished)
    assert summary["status"] == "infeasible"
    assert set(summary["explain"]["families"]) <= {"joint_speed", "reach"}
    assert "walk slower" in summary["explain"]["advice"]
    assert summary["segments"] == []
    assert summary["error"] is None


def test_a_run_without_a_solution_leaves_no_file_of_a_simulation(gaitforge: Run) -> None:
    finished = gaitforge("robot=hexapod", "task.speed=2.0")
    names = {name.rpartition("/")[2] for name in finished.files}
    assert {"summary.json", "manifest.json", "robot.urdf", "report.html", ".hydra"} <= names
    assert not {"run.mcap", "plan.npz", "footfall.png"} & names
    assert not [name for name in names if name.endswith(".part")]
