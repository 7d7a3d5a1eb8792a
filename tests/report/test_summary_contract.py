"""``summary.json`` keeps its contract whatever a run came to."""

from __future__ import annotations

import copy
import json
import math
from dataclasses import replace
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from gaitforge.errors import InfeasibleFootfall, InputError, Problem
from gaitforge.report.summary import build_summary, segment_entries, segment_entry, write_summary
from gaitforge.report.text import checks_text, ignored_text, opinions_text, welded_text
from gaitforge.verify.agreement import opinions

SCHEMA = json.loads((Path(__file__).parents[1] / "contracts" / "summary.schema.json").read_text())
PAGE = Path(__file__).parents[2] / "docs" / "summary_json.md"


def check(summary):
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    jsonschema.validate(json.loads(json.dumps(summary, allow_nan=False)), SCHEMA)
    return summary


def finished(verdict, **changes):
    given = {
        "robot": "hexapod",
        "task": "walk",
        "status": "unverified",
        "segments": segment_entries(verdict.timeline, verdict.speeds),
        "checks": verdict.checks,
        "timings": {"assemble": 0.1, "total": 3.0},
    }
    return build_summary(**(given | changes))


def test_a_finished_run_keeps_the_contract(verdict):
    summary = check(finished(verdict))
    assert [s["name"] for s in summary["segments"]] == [e.plan.name for e in verdict.timeline.entries]
    assert summary["segments"][1]["speed_measured_m_s"] == 0.0634
    assert summary["segments"][2]["relaxed"] == ["gap rule"]
    assert summary["checks"][0]["limit"] == 0.05
    assert summary["timings_s"]["verify"] == 0.0


def test_the_opinions_of_two_simulators_keep_the_contract(verdict):
    fails = [replace(c, simulator="mujoco", passed=False) for c in verdict.checks]
    other = replace(verdict, simulator="mujoco", checks=tuple(fails))
    both = replace(verdict, checks=verdict.checks + other.checks, others=(other,))
    summary = check(finished(both, opinions=opinions(both)))
    assert summary["opinions"]["passed"] == {"pybullet": False, "mujoco": False}
    assert [d["name"] for d in summary["opinions"]["disagreements"]] == ["speed", "cost_of_transport"]
    told = opinions_text(summary)
    assert "pybullet does not, mujoco does not" in told
    assert "speed of all: pybullet 0.0634 (holds), mujoco 0.0634 (fails)" in told
    assert "simulator" in checks_text(summary).splitlines()[0]
    assert opinions_text(finished(verdict)) == ""


def test_a_verified_run_keeps_the_contract(verdict):
    check(finished(verdict, status="verified", checks=[c for c in verdict.checks if c.passed]))


def test_a_verified_run_with_a_failed_check_breaks_it(verdict):
    with pytest.raises(jsonschema.ValidationError):
        check(finished(verdict, status="verified"))


def test_numbers_that_are_not_finite_are_null(verdict):
    summary = check(finished(verdict, segments=[segment_entry(verdict.timeline.entries[1].plan, math.nan)]))
    assert summary["segments"][0]["speed_measured_m_s"] is None
    assert summary["checks"][2]["value"] is None


def test_links_that_were_let_through_each_other_are_told(verdict):
    trace = replace(verdict.trace, overlapping=(("base", "thigh"), ("base", "hip")))
    found = replace(verdict, trace=trace)
    summary = check(finished(found, ignored_contacts=found.ignored_contacts))
    assert summary["ignored_contacts"] == {"pybullet": [["base", "thigh"], ["base", "hip"]]}
    assert ignored_text(summary).endswith("base and thigh, base and hip")
    assert ignored_text(check(finished(verdict))) == ""


def test_what_a_weld_held_is_told(verdict):
    summary = check(finished(verdict, welded=("box",)))
    assert summary["welded"] == ["box"]
    assert welded_text(summary) == "held by a weld, not by friction: box"
    assert welded_text(check(finished(verdict))) == ""


def test_an_infeasible_run_explains_itself(verdict):
    error = InfeasibleFootfall("no", {"families": ("g5", "g9"), "limbs": np.array([1, 2]), "margin": np.float64(0.5)})
    summary = check(build_summary(robot="r", task="t", status="infeasible", explain=error.explain))
    assert summary["explain"] == {"families": ["g5", "g9"], "limbs": [1, 2], "margin": 0.5}


def test_bad_input_is_told_with_file_and_key():
    error = InputError(Problem("robot.yaml", "limbs.L1", "'L9'", "one of L1, L2"))
    summary = check(build_summary(robot="r", task="t", status="error", error=error.as_dict()))
    assert summary["error"]["key"] == "limbs.L1"


@pytest.mark.parametrize(
    ("changes", "message"), [({"status": "fine"}, "status 'fine'"), ({"timings": {"cook": 1.0}}, "stages cook")]
)
def test_words_that_the_contract_does_not_know_are_refused(verdict, changes, message):
    with pytest.raises(ValueError, match=message):
        finished(verdict, **changes)


def test_the_schema_refuses_a_summary_with_a_key_less_or_more(verdict):
    good = finished(verdict)
    for place in ((), ("segments", 0), ("checks", 0), ("timings_s",)):
        node = good
        for step in place:
            node = node[step]
        for key in node:
            bad = copy.deepcopy(good)
            target = bad
            for step in place:
                target = target[step]
            del target[key]
            assert not jsonschema.Draft202012Validator(SCHEMA).is_valid(bad), key
        bad = copy.deepcopy(good)
        target = bad
        for step in place:
            target = target[step]
        target["surprise"] = 1
        assert not jsonschema.Draft202012Validator(SCHEMA).is_valid(bad), place


def test_the_summary_file_is_the_summary(tmp_path, verdict):
    summary = finished(verdict)
    write_summary(tmp_path / "summary.json", summary)
    assert json.loads((tmp_path / "summary.json").read_text()) == summary


def test_the_page_names_every_key_of_the_contract():
    text = PAGE.read_text()
    item = SCHEMA["properties"]
    keys = {*item, *item["segments"]["items"]["properties"], *item["checks"]["items"]["properties"]}
    keys |= {*item["timings_s"]["properties"], *item["error"]["properties"], *item["status"]["enum"]}
    assert {key for key in keys if f"`{key}`" not in text} == set()


def test_a_plan_that_was_relaxed_says_so_once_for_pattern_and_motion(verdict):
    plan = verdict.timeline.entries[2].plan
    both = replace(plan, pattern=replace(plan.pattern, relaxed=("δ 5 mm",)), relaxed=("w_min",))
    assert segment_entry(both)["relaxed"] == ["δ 5 mm", "w_min"]
