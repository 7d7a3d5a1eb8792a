"""A sweep runs on after a bad job and exits with the worst code."""

from __future__ import annotations

import json
from collections.abc import Callable

import pytest

from gaitforge.cli.app import worst
from tests.conftest import Finished

Run = Callable[..., Finished]
TOO_FAST = "task.speed=2.0"


def summaries(finished: Finished) -> dict[str, str]:
    """Robot → status of every job that left a summary."""
    found = [json.loads(p.read_text()) for p in finished.folder.rglob("summary.json")]
    return {s["robot"]: s["status"] for s in found}


def test_a_sweep_gives_every_job_its_folder_and_a_table(gaitforge: Run) -> None:
    finished = gaitforge("--multirun", "robot=hexapod,quadruped", "task=walk", TOO_FAST)
    assert summaries(finished) == {"hexapod": "infeasible", "quadruped": "infeasible"}
    assert finished.code == 3
    table = finished.out[finished.out.rindex("robot ") :]
    assert "hexapod" in table
    assert "quadruped" in table
    assert all(name.startswith("outputs") for name in finished.files)


@pytest.mark.parametrize(
    ("bad", "message"),
    [
        ("robot=octopus,hexapod", "'octopus'"),
        ("robot=hexapod,octopus", "'octopus'"),
        ("robot=hexapod task.phases.0.cycles=0,2", "phases.0.cycles"),
    ],
)
def test_a_bad_job_does_not_stop_the_others(gaitforge: Run, bad: str, message: str) -> None:
    finished = gaitforge("--multirun", *bad.split(), TOO_FAST)
    assert summaries(finished) == {"hexapod": "infeasible"}
    assert finished.code == 2
    assert message in finished.err
    assert "Traceback" not in finished.err


def test_a_job_with_bad_input_leaves_no_folder_in_a_sweep(gaitforge: Run) -> None:
    finished = gaitforge("--multirun", "task.phases.0.cycles=-1,0")
    assert finished.code == 2
    assert [name for name in finished.files if name != "outputs"] == []


@pytest.mark.parametrize(
    ("codes", "expected"),
    [([0, 0], 0), ([0, 1], 1), ([1, 5, 0], 5), ([5, 3], 3), ([3, 2], 2), ([2, 4, 0], 4), ([], 0)],
)
def test_the_worst_code_of_a_sweep_is_its_exit_code(codes: list[int], expected: int) -> None:
    assert worst(codes) == expected


def test_a_run_after_a_sweep_in_the_same_process_answers_for_itself_alone(gaitforge):
    assert gaitforge("--multirun", "robot=hexapod,nobody", "task.speed=9.0").code == 2
    alone = gaitforge("robot=hexapod", "task.sped=0.05")
    assert alone.code == 2
    assert "nobody" not in alone.out + alone.err
    assert gaitforge("robot=hexapod", "task.speed=9.0").out.count("infeasible") == 1
