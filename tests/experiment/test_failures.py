"""Subsets of lost limbs as data."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import pytest

from gaitforge.errors import InputError
from gaitforge.experiment.engine import fingerprints
from gaitforge.experiment.experiment import Tools
from gaitforge.experiment.failures import Failures
from gaitforge.experiment.gaits import robot_called
from gaitforge.experiment.loss import LossJob
from gaitforge.pipeline.options import Options
from gaitforge.report.losses_plot import _counted, losses_png

OPTIONS = Options(simulator=None, recorder=None)  # type: ignore[arg-type]  # what is proven is not simulated


def failures(**more: Any) -> Failures:
    return Failures(**{"title": "t", "simulators": {"none": None}, "robots": {"hexapod": [0, "all"]}, **more})


def lost(experiment: Failures) -> list[tuple[str, ...]]:
    return [job.limbs for job in experiment.jobs() if isinstance(job, LossJob)]


def test_all_subsets_are_all_combinations() -> None:
    names = robot_called("hexapod").limb_names
    every = failures(robots={"hexapod": ["all"] * 3})
    assert lost(every) == [c for k in (1, 2, 3) for c in combinations(names, k)]
    assert len(lost(failures(robots={"dodecapod": ["all"] * 4}))) == 793


def test_a_sample_is_some_of_them_drawn_from_the_seed() -> None:
    robots = {"dodecapod": [0, 0, 7]}
    one, again, other = (lost(failures(robots=robots, seed=seed)) for seed in (1, 1, 2))
    assert len(set(one)) == 7
    assert one == again
    assert one != other
    assert set(one) <= set(combinations(robot_called("dodecapod").limb_names, 3))


def test_every_mode_of_a_subset_is_a_job_of_its_own() -> None:
    jobs = failures(modes=("locked", "limp"), robots={"hexapod": [1]}).jobs()
    assert [job.key.split(".")[2] for job in jobs] == ["locked", "limp"]
    assert len({job.key for job in jobs}) == 2


@pytest.mark.parametrize("more", [{"modes": ("broken",)}, {"modes": ()}])
def test_modes_that_do_not_exist_are_refused(more: dict[str, Any]) -> None:
    with pytest.raises(InputError, match="modes"):
        failures(**more).jobs()


@pytest.mark.parametrize("counts", [["all"] * 7, ["some"], [-1], [True], {1: 3}, 6, "all"])
def test_numbers_of_subsets_that_make_no_sense_are_refused(counts: Any) -> None:
    with pytest.raises(InputError, match=r"robots\.hexapod"):
        failures(robots={"hexapod": counts}).jobs()


def test_rows_of_a_smaller_sample_or_of_fewer_robots_are_kept_in_a_larger_one() -> None:
    small = {"robots": {"hexapod": [1]}, "modes": ["locked"], "seed": 0}
    large = {"robots": {"hexapod": ["all"], "dodecapod": [2]}, "modes": ["locked", "limp"], "seed": 0}

    def prints(named: dict[str, Any], **config: Any) -> dict[str, str]:
        experiment = failures(**named)
        return fingerprints({"experiment": {**named, **config}}, experiment, experiment.jobs())

    ((key, made),) = prints(small).items()
    assert prints(large)[key] == made
    assert prints(small, simulators={"mujoco": {}})[key] != made
    assert prints({**small, "seed": 1}).get(key) != made


@pytest.mark.parametrize("limbs", [("L1", "L2"), ("R1", "R3"), ("L1", "R2", "L3")])
def test_a_hexapod_that_cannot_walk_any_more_is_a_measured_row_with_a_proof(limbs: tuple[str, ...]) -> None:
    (row,) = LossJob("hexapod", limbs, "locked").measure(Tools(OPTIONS, {}))
    assert (row["status"], row["settled"], row["verified"]) == ("infeasible", True, False)
    assert row["proof"].startswith("{g")


def test_the_picture_counts_every_row_once_in_the_bar_of_its_simulator() -> None:
    case = {"robot": "hexapod", "mode": "locked"}
    rows = [
        {**case, "lost": 1, "simulator": "pybullet", "status": "verified"},
        {**case, "lost": 1, "simulator": "mujoco", "status": "unverified"},
        {**case, "lost": 2, "status": "infeasible"},
        {**case, "lost": 2, "status": "unsolved"},
    ]
    assert _counted(rows) == {
        "hexapod, 1 locked, pybullet": {"verified": 1},
        "hexapod, 1 locked, mujoco": {"unverified": 1},
        "hexapod, 2 locked, pybullet": {"infeasible": 1, "unsolved": 1},
        "hexapod, 2 locked, mujoco": {"infeasible": 1, "unsolved": 1},
    }
    assert list(_counted(rows[::2])) == ["hexapod, 1 locked", "hexapod, 2 locked"]
    limp = {**case, "mode": "limp", "lost": 2, "status": "infeasible"}
    assert _counted([*rows, limp])["hexapod, 2 limp"] == {"infeasible": 1}
    assert losses_png(rows)[:4] == b"\x89PNG"
    assert losses_png(rows) == losses_png(list(rows))
    assert losses_png(rows) != losses_png(rows[:3])
