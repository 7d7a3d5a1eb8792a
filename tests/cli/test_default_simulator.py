"""Where PyBullet is not installed, MuJoCo judges, and the user is told."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from typing import Any

import pytest

from gaitforge.cli.app import _with_simulator
from tests.conftest import Finished

Run = Callable[..., Finished]


def test_pybullet_judges_where_it_is_installed() -> None:
    assert _with_simulator(["robot=hexapod"]) == ["robot=hexapod"]


@pytest.fixture
def without_pybullet(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pybullet", None)


@pytest.mark.usefixtures("without_pybullet")
def test_mujoco_verifies_and_records_a_walk_without_pybullet(gaitforge: Run) -> None:
    finished = gaitforge("robot=hexapod", "task=walk")
    assert finished.code == 0, finished.out + finished.err
    assert "MuJoCo judges: verify=mujoco" in finished.out
    (file,) = finished.folder.glob("outputs/*/*/*/summary.json")
    summary: dict[str, Any] = json.loads(file.read_text())
    assert summary["status"] == "verified"
    assert (file.parent / "run.mcap").exists()
    assert "<img" in (file.parent / "report.html").read_text()


@pytest.mark.usefixtures("without_pybullet")
@pytest.mark.parametrize("asked", ["verify=pybullet", "+verify=mujoco", "experiment=table1", "--help", "--cfg"])
def test_what_was_asked_for_is_left_as_it_is(asked: str) -> None:
    assert _with_simulator(["robot=hexapod", asked]) == ["robot=hexapod", asked]


@pytest.mark.usefixtures("without_pybullet")
@pytest.mark.parametrize("flag", [["--multirun"], ["--config-dir", "mine"], ["verify.friction=0.5"]])
def test_sweeps_and_own_tasks_are_judged_by_mujoco_too(flag: list[str]) -> None:
    assert _with_simulator([*flag, "task=walk"]) == [*flag, "task=walk", "verify=mujoco"]


@pytest.mark.usefixtures("without_pybullet")
def test_pybullet_asked_for_by_name_is_refused_in_a_line(gaitforge: Run) -> None:
    finished = gaitforge("robot=hexapod", "task=walk", "verify=pybullet")
    assert finished.code == 4
    assert "PyBullet is not installed" in finished.out + finished.err
    assert "Traceback" not in finished.out + finished.err
