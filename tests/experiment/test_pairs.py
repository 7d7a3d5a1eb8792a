"""Pairs of gaits: what is planned, executed and written into a row."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gaitforge.cli.experiment import build_experiment
from gaitforge.config import plain
from gaitforge.errors import InputError
from gaitforge.experiment.engine import ExperimentRun, run_experiment
from gaitforge.experiment.pairs import Pairs
from gaitforge.pipeline.options import Options
from gaitforge.resources import conf_dir
from gaitforge.verify.pybullet import PyBulletSimulator
from tests.cli.test_compose import composed

EXPERIMENTS = sorted(p.stem for p in (conf_dir() / "experiment").glob("*.yaml"))
TWO = {"hexapod": {"quick": {"gait": "tripod", "speed": 0.064}, "slow": {"gait": "tripod", "speed": 0.05}}}


def pairs(robots: Any = TWO, **named: Any) -> Pairs:
    return Pairs(title="Pairs", simulators={"pybullet": PyBulletSimulator()}, robots=robots, workers=1, **named)


def built(name: str) -> Any:
    return build_experiment(plain(composed(f"experiment={name}"))["experiment"])


def test_table1_has_every_ordered_pair_by_both_methods_beside_the_papers_speed() -> None:
    jobs = built("table1").jobs()
    assert len(jobs) == 12
    found = {(j.case["before"], j.case["after"], j.case["method"]): j.case["published_m_s"] for j in jobs}
    assert found["six", "four", "interpolate"] == -0.04
    assert found["five", "four", "optimise"] == 0.059
    assert None not in found.values()


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_the_jobs_of_every_experiment_have_keys_of_their_own(name: str) -> None:
    counts = Counter(job.key for job in built(name).jobs())
    assert max(counts.values()) == 1
    assert all(set(key) <= set("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-") for key in counts)


def test_free_limbs_are_held_and_the_others_walk() -> None:
    experiment = pairs({"hexapod": {"six": {}, "four": {"free": ["L1", "R1"], "gait": "wave"}}})
    roles = experiment.gaits["hexapod"]["four"].phase.roles
    assert {name: type(role).__name__ for name, role in roles.items()} == {"L1": "Held", "R1": "Held"}


@pytest.mark.parametrize(
    ("robots", "message"),
    [
        ({"hexapod": {"a": {"free": ["L9"]}, "b": {}}}, "L9"),
        ({"hexapod": {"a": {"sped": 0.1}, "b": {}}}, "sped"),
        ({"hexapod": {"a": {"free": "L1"}, "b": {}}}, "a list of limbs"),
        ({"hexapod": {"a": {}}}, "at least two"),
        ({"octopus": {"a": {}, "b": {}}}, "octopus"),
    ],
)
def test_gaits_that_make_no_sense_are_refused_with_their_key(robots: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        pairs(robots).jobs()


@pytest.fixture(scope="module")
def interpolated(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[dict[str, Any]], list[str]]:
    """Folder, rows and what was told of two tripods of different speed, blended into each other."""
    folder, told = tmp_path_factory.mktemp("pairs"), []
    run = ExperimentRun("two", pairs(methods=("interpolate",)), Options(None, None), folder, {})  # type: ignore[arg-type]
    outcome = run_experiment(run, lambda stage, message: told.append(message))
    return folder, list(outcome.results["rows"]), told


def test_each_gait_is_planned_once(interpolated: tuple[Path, list[dict[str, Any]], list[str]]) -> None:
    told = interpolated[2]
    assert sum(message.startswith("gait hexapod.quick") for message in told) == 1
    assert sum(message.startswith("gait hexapod.slow") for message in told) == 1


def test_a_blend_of_two_tripods_walks_at_about_their_mean_speed(
    interpolated: tuple[Path, list[dict[str, Any]], list[str]],
) -> None:
    folder, rows, _ = interpolated
    assert [(r["before"], r["after"]) for r in rows] == [("quick", "slow"), ("slow", "quick")]
    for row in rows:
        assert row["measured"]
        assert not row["fallen"]
        assert row["speed_planned_m_s"] == pytest.approx(0.057, rel=0.03)
        assert row["speed_m_s"] == pytest.approx(row["speed_share"] * 0.057)
        assert row["speed_m_s"] == pytest.approx(0.057, rel=0.1)
    assert (folder / "results.png").read_bytes()[:4] == b"\x89PNG"


def test_the_picture_of_many_pairs_is_a_matrix(interpolated: tuple[Path, list[dict[str, Any]], list[str]]) -> None:
    from gaitforge.report.change_plot import FEW, change_png

    names = [f"g{i}" for i in range(5)]
    rows = [{**interpolated[1][0], "before": a, "after": b} for a in names for b in names if a != b]
    assert len(rows) > FEW
    few, many = (_size(change_png(some)) for some in (interpolated[1], rows))
    assert many != few


def _size(png: bytes) -> tuple[int, ...]:
    return tuple(int(n) for n in np.frombuffer(png[16:24], dtype=">u4"))
