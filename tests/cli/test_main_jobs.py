"""The jobs that gaitforge exists for, as a user types them."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.conftest import Finished

Run = Callable[..., Finished]
FILES = {
    ".hydra", "robot.urdf", "footfall.csv", "footfall.png", "speed.png", "plan.npz", "run.mcap", "run.layout.json",
    "report.html", "manifest.json", "summary.json",
}  # fmt: skip


def verified(finished: Finished, *kinds: str) -> tuple[Path, dict[str, Any]]:
    """The folder and summary of a run that must be verified and have these kinds of segments in order."""
    assert finished.code == 0, finished.out + finished.err
    (file,) = finished.folder.glob("outputs/*/*/*/summary.json")
    summary = json.loads(file.read_text())
    assert {p.name for p in file.parent.iterdir()} == FILES
    assert summary["status"] == "verified"
    assert all(check["passed"] for check in summary["checks"])
    assert [s["kind"] for s in summary["segments"]] == ["stand", *kinds, "stand"]
    assert set(summary["timings_s"]) == {"assemble", "footfall", "motion", "verify", "record", "total"}
    return file.parent, summary


def gait_speeds(summary: dict[str, Any]) -> list[tuple[float, float]]:
    return [(s["speed_planned_m_s"], s["speed_measured_m_s"]) for s in summary["segments"] if s["kind"] == "gait"]


def test_a_hexapod_walks_in_an_alternating_tripod_as_planned(gaitforge: Run) -> None:
    finished = gaitforge("robot=hexapod", "task=walk")
    folder, summary = verified(finished, "gait")
    ((planned, measured),) = gait_speeds(summary)
    assert planned == pytest.approx(0.064, rel=1e-6)
    assert measured == pytest.approx(planned, rel=0.03)
    for word in ("verified", "6.40", "run.mcap", "run.layout.json", "Foxglove", "files"):
        assert word in finished.out
    plan = np.load(folder / "plan.npz")
    assert plan["walk/C"].shape == (6, 12)
    rows, samples = plan["walk/P"].shape
    assert rows == 20
    assert (samples - 1) % 12 == 0


def test_a_quadruped_walks_in_a_wave(gaitforge: Run) -> None:
    _, summary = verified(gaitforge("robot=quadruped", "task=walk"), "gait")
    assert summary["segments"][1]["source"] == "wave"


def test_a_hexapod_frees_a_limb_while_it_walks(gaitforge: Run) -> None:
    folder, summary = verified(gaitforge("robot=hexapod", "task=transition"), "gait", "transition", "gait")
    limbs = [len(s["limbs_locomotive"]) for s in summary["segments"]]
    assert limbs[1] == 6
    assert limbs[3] == 5
    plan = np.load(folder / "plan.npz")
    before, move, after = (plan[f"{name}/P"] for name in ("all", "all_to_without_R1", "without_R1"))
    assert np.abs(before[:, -1] - move[:, 0]).max() <= 1e-6
    assert np.abs(move[:, -1] - after[:, 0]).max() <= 1e-6


def test_a_dodecapod_carries_a_package_and_points_its_camera_at_the_pipe_while_nine_limbs_walk(gaitforge: Run) -> None:
    """The main job of the README."""
    finished = gaitforge("robot=dodecapod", "task=camera_leg")
    assert finished.code == 0, finished.out + finished.err
    (file,) = finished.folder.glob("outputs/*/*/*/summary.json")
    summary = json.loads(file.read_text())
    assert summary["status"] == "verified"
    gaits = [s for s in summary["segments"] if s["kind"] == "gait"]
    assert [len(s["limbs_locomotive"]) for s in gaits] == [10, 9]
    checks = {(c["name"], c["segment"]): c["value"] for c in summary["checks"]}
    assert checks["camera_pointing", "inspect"] <= 2.5
    assert {"load_place", "load_angle"} <= {name for name, _ in checks}


def test_a_dodecapod_points_its_camera_at_the_pipe_while_eleven_limbs_walk(gaitforge: Run) -> None:
    _, summary = verified(gaitforge("robot=dodecapod", "task=camera_only"), "gait", "transition", "gait")
    assert len(summary["segments"][3]["limbs_locomotive"]) == 11
    for planned, measured in gait_speeds(summary):
        assert planned == pytest.approx(0.064, rel=1e-6)
        assert measured == pytest.approx(planned, rel=0.05)
    pointing = [c for c in summary["checks"] if c["name"] == "camera_pointing" and c["segment"] == "inspect"]
    assert pointing
    assert max(c["value"] for c in pointing) <= 2.5
