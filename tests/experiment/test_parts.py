"""A small, fixed part of each experiment, from the command line to its page."""

from __future__ import annotations

import json
from collections.abc import Callable

import pytest

from tests.conftest import Finished

PARTS = {
    "table1": "hexapod.six_to_five.optimise",
    "quadruped": "quadruped.wave_to_slow.optimise",
    "pairs": "hexapod.six_to_slow.optimise",
}


@pytest.mark.parametrize("name", PARTS)
def test_an_optimised_transition_of_each_experiment_is_verified(gaitforge: Callable[..., Finished], name: str) -> None:
    finished = gaitforge(
        f"experiment={name}", f"experiment.only=[{PARTS[name]}]", "experiment.workers=1", "motion/solver=structured"
    )
    assert finished.code == 0, finished.err + finished.out
    (file,) = (finished.folder / "outputs" / "experiments" / name).glob("*/results.json")
    results = json.loads(file.read_text())
    assert [row["simulator"] for row in results["rows"]] == ["pybullet", "mujoco"]
    for row in results["rows"]:
        assert row["verified"]
        assert row["accepted"]
        assert row["speed_share"] >= 0.95
        assert row["heading_deg"] <= 3.0
        assert {c["key"] for c in results["columns"]} <= set(row)
    page = (file.parent / "results.md").read_text()
    assert f"gaitforge experiment={name} experiment.only=[{PARTS[name]}]" in page
    assert (file.parent / "results.png").exists()
