"""What a run leaves: manifest, summary, and nothing half-written."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from gaitforge.errors import InputError, SimulationError
from gaitforge.pipeline.manifest import code_hash, config_hash, manifest
from gaitforge.pipeline.options import Options
from gaitforge.pipeline.run import Run
from gaitforge.pipeline.run_task import run_task
from gaitforge.pipeline.stopwatch import Stopwatch
from gaitforge.record.recorder import McapRecorder
from gaitforge.robot.load import load_robot
from gaitforge.task.load import load_task
from gaitforge.verify.pybullet import PyBulletSimulator


class Broken:
    """A simulator that fails."""

    name = "broken"

    def __init__(self, error: Exception) -> None:
        self.error = error

    def run(self, *args: Any, **more: Any) -> Any:
        raise self.error


def run_with(folder: Path, simulator: Any) -> Run:
    robot = load_robot("hexapod")
    task = load_task({"phases": [{"name": "walk", "cycles": 1}]}, "walk", robot=robot)
    return Run(robot, task, Options(simulator=simulator, recorder=McapRecorder()), folder, {"seed": 0})


def summary_in(folder: Path) -> dict[str, Any]:
    return json.loads((folder / "summary.json").read_text())


def test_a_simulator_that_refuses_is_an_error_in_the_summary(tmp_path: Path) -> None:
    outcome = run_task(run_with(tmp_path, Broken(SimulationError("too many joints"))), Stopwatch())
    assert (outcome.status, outcome.code) == ("error", 4)
    summary = summary_in(tmp_path)
    assert summary["error"]["type"] == "SimulationError"
    assert summary["error"]["found"] == "too many joints"
    assert [s["name"] for s in summary["segments"]] == ["start", "walk", "stop"]
    assert (tmp_path / "plan.npz").exists()
    assert not (tmp_path / "run.mcap").exists()


def test_an_error_of_our_own_making_is_told_in_the_summary_and_raised(tmp_path: Path) -> None:
    with pytest.raises(ZeroDivisionError):
        run_task(run_with(tmp_path, Broken(ZeroDivisionError("oops"))), Stopwatch())
    assert summary_in(tmp_path)["error"] == {
        "type": "ZeroDivisionError", "file": None, "key": None, "found": "oops", "expected": None,
    }  # fmt: skip


def test_a_summary_of_an_earlier_run_does_not_survive_into_a_new_one(tmp_path: Path) -> None:
    (tmp_path / "summary.json").write_text("old")
    (tmp_path / "robot.urdf").mkdir()
    (tmp_path / "robot.urdf" / "in the way").write_text("")
    with pytest.raises(InputError):
        run_task(run_with(tmp_path, PyBulletSimulator()), Stopwatch())
    assert not (tmp_path / "summary.json").exists()
    assert not list(tmp_path.glob(".*.part"))


def test_the_manifest_says_what_made_the_run() -> None:
    made = manifest({"seed": 7}, "<robot/>", 7)
    assert made["seed"] == 7
    assert made["versions"]["hydra-core"].startswith("1.3.")
    assert all(made["versions"].values())
    assert set(made["threads"]) == {"OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"}
    assert json.loads(json.dumps(made, allow_nan=False)) == made


def test_the_code_hash_knows_names_and_contents_of_sources_but_not_their_folder(tmp_path: Path) -> None:
    def package(name: str, **sources: str) -> str:
        for file, text in sources.items():
            path = tmp_path / name / "inner" / f"{file}.py"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        (tmp_path / name / "inner" / "a.pyc").write_text(name)
        return code_hash(tmp_path / name)

    one = package("one", a="x = 1\n", b="")
    assert one == package("two", a="x = 1\n", b="")
    assert len({one, package("three", a="x = 2\n", b=""), package("four", a="x = 1\n", c="")}) == 3
    assert code_hash() == manifest({}, "", 0)["code_sha256"]


def test_the_config_hash_tells_runs_apart_but_not_folders() -> None:
    config = {"robot": {"name": "hexapod", "file": "/a/robot.yaml"}, "seed": 0, "outputs": "/a", "debug": False}
    moved = {"robot": {"name": "hexapod", "file": "/b/robot.yaml"}, "seed": 0, "outputs": "/b", "debug": True}
    assert config_hash(config) == config_hash(moved)
    assert config_hash(config) != config_hash({**config, "seed": 1})
