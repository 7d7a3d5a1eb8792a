"""The engine: rows are measured once, a bad one never ends the others, and the exit code says what happened."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from gaitforge.errors import InputError
from gaitforge.experiment import engine
from gaitforge.experiment.engine import run_experiment
from tests.experiment.cheap import cheap_run, marks

RULE = {"where": {"simulator": "none"}, "at_least": {"value": 1.0}}


def test_every_row_is_in_the_results_in_the_order_of_the_jobs(tmp_path: Path) -> None:
    outcome = run_experiment(cheap_run(tmp_path, {"b": 2.0, "a": 1.0}, accept=(RULE,)))
    written = json.loads((tmp_path / "run" / "results.json").read_text())
    assert outcome.code == 0
    assert [(row["key"], row["value"], row["accepted"]) for row in written["rows"]] == [
        ("b", 2.0, True),
        ("a", 1.0, True),
    ]
    assert written["counts"] == {"rows": 2, "measured": 2, "judged": 2, "accepted": 2}
    assert written["schema"] == 1


@pytest.mark.parametrize(
    ("values", "status", "code"),
    [
        ({"a": 1.0, "low": 0.5}, "unverified", 1),
        ({"a": 1.0, "unsolved": 1.0}, "unsolved", 5),
        ({"broken": 1.0, "unsolved": 1.0, "low": 0.5}, "error", 4),
    ],
)
def test_the_worst_row_gives_the_exit_code(tmp_path: Path, values: dict[str, float], status: str, code: int) -> None:
    outcome = run_experiment(cheap_run(tmp_path, values, accept=(RULE,)))
    assert (outcome.status, outcome.code) == (status, code)
    assert marks(tmp_path) == list(values)


def test_a_row_that_no_rule_speaks_of_is_a_result(tmp_path: Path) -> None:
    rule = {**RULE, "where": {"simulator": "another"}}
    outcome = run_experiment(cheap_run(tmp_path, {"low": 0.5}, accept=(rule,)))
    assert (outcome.code, outcome.results["rows"][0]["accepted"]) == (0, None)


def test_an_error_becomes_a_row_that_says_what_happened(tmp_path: Path) -> None:
    rows = run_experiment(cheap_run(tmp_path, {"broken": 1.0, "unsolved": 1.0})).results["rows"]
    assert [(r["measured"], r["status"], r["error"]) for r in rows] == [
        (False, "error", "ZeroDivisionError: by zero"),
        (False, "unsolved", "no plan"),
    ]
    page = (tmp_path / "run" / "results.md").read_text()
    assert "- `unsolved`: no plan" in page


def test_a_second_run_in_the_folder_measures_only_what_is_missing(tmp_path: Path) -> None:
    run_experiment(cheap_run(tmp_path, {"a": 1.0, "unsolved": 1.0}))
    outcome = run_experiment(cheap_run(tmp_path, {"a": 1.0, "unsolved": 1.0}, workers=1, only=("a", "uns*")))
    assert marks(tmp_path) == ["a", "unsolved", "unsolved"]
    assert outcome.results["rows"][0]["value"] == 1.0


def test_rows_of_another_config_or_another_robot_are_measured_again(tmp_path: Path) -> None:
    run = cheap_run(tmp_path, {"a": 1.0})
    run_experiment(run)
    run_experiment(replace(run, config={**run.config, "seed": 1}))
    run_experiment(cheap_run(tmp_path, {"a": 1.0}, version="heavier"))
    assert marks(tmp_path) == ["a", "a", "a"]


@pytest.mark.parametrize("what", ["code_hash", "versions"])
def test_rows_of_other_code_or_libraries_are_measured_again_and_it_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, what: str
) -> None:
    run, told = cheap_run(tmp_path, {"a": 1.0}), list[str]()
    run_experiment(run)
    monkeypatch.setattr(engine, what, lambda: "another")
    run_experiment(run, lambda _, text: told.append(text))
    run_experiment(run, lambda _, text: told.append(text))
    assert marks(tmp_path) == ["a", "a"]
    assert told[0] == "1 are measured again: by other code, libraries or config, or without a result"
    assert told[2] == "1 of 1 jobs were measured before"


def test_half_a_file_is_no_row(tmp_path: Path) -> None:
    run = cheap_run(tmp_path, {"a": 1.0})
    run_experiment(run)
    (tmp_path / "run" / "rows" / "a.json").write_text('{"fingerprint": "')
    assert run_experiment(run).code == 0
    assert marks(tmp_path) == ["a", "a"]


def test_only_takes_the_jobs_whose_keys_match(tmp_path: Path) -> None:
    outcome = run_experiment(cheap_run(tmp_path, {"a.x": 1.0, "b.x": 1.0, "b.y": 1.0}, only=("b.*",)))
    assert [row["key"] for row in outcome.results["rows"]] == ["b.x", "b.y"]


def test_an_only_that_matches_nothing_is_refused_and_leaves_no_folder(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"experiment: only: .*keys such as a"):
        run_experiment(cheap_run(tmp_path, {"a": 1.0}, only=("z*",)))
    assert not (tmp_path / "run").exists()


def test_a_process_that_dies_loses_its_own_row_alone(tmp_path: Path) -> None:
    outcome = run_experiment(cheap_run(tmp_path, {"a": 1.0, "deadly": 1.0, "b": 1.0, "c": 1.0}, workers=2))
    assert [row["measured"] for row in outcome.results["rows"]] == [True, False, True, True]
    assert "died" in outcome.results["rows"][1]["error"]
    assert outcome.code == 4
