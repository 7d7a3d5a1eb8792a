"""The log as a file: whole, valid, reproducible."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from mcap.reader import make_reader
from run_by_hand import SCENE, START_NS

from gaitforge.errors import InputError
from gaitforge.record import write_log
from gaitforge.record.reader import read_run
from gaitforge.record.recorder import McapRecorder

ONCE = (
    "/robot_description",
    "/plan/robot_description",
    "/plan/path",
    "/footfall/matrix",
    "/viz/footholds",
    "/verify/report",
)
STATES = ("/tf", "/plan/tf", "/sim/base", "/sim/joint_states", "/plan/joint_states", "/sim/contacts", "/metrics")
COLUMNS = ("/footfall/plan", "/footfall/sim", "/footfall/cursor")
OTHERS = {"/plan/segment", "/state", "/footfall/compare", "/viz/support", "/viz/forces", "/viz/scene", "/log"}


def raw_messages(path: Path):
    with path.open("rb") as stream:
        yield from make_reader(stream, validate_crcs=True).iter_messages(log_time_order=False)


def test_pymcap_cli_doctor_finds_nothing_wrong(log_path):
    command = [str(Path(sys.executable).parent / "pymcap-cli"), "doctor", str(log_path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "passed" in done.stdout
    assert "warning" not in done.stdout.lower()


def test_every_topic_has_the_messages_that_its_rate_asks_for(log, verdict):
    duration, timeline = verdict.timeline.duration, verdict.timeline
    columns = sum(e.cycles * e.plan.pattern.columns for e in timeline.entries)
    assert set(log.topics) == {*ONCE, *STATES, *COLUMNS, *OTHERS}
    assert {log.topics[t] for t in ONCE} == {1}
    assert {log.topics[t] for t in STATES} == {int(50 * duration) + 1}
    assert {log.topics[t] for t in COLUMNS} == {columns}
    assert log.topics["/viz/support"] == log.topics["/viz/forces"] == int(25 * duration) + 1
    assert log.topics["/plan/segment"] == len(timeline.entries)
    assert log.topics["/state"] == sum(e.cycles for e in timeline.entries)


def test_messages_lie_in_the_file_by_time_from_the_start_to_the_end_of_the_run(log_path, verdict):
    times = [m.log_time for _, _, m in raw_messages(log_path)]
    assert times == sorted(times)
    assert times[0] == START_NS
    assert times[-1] == START_NS + round(verdict.trace.times[-1] * 1e9)
    assert all(m.log_time == m.publish_time for _, _, m in raw_messages(log_path))


def test_sequence_numbers_count_the_messages_of_a_topic(log_path):
    seen: dict[str, list[int]] = {}
    for _, channel, message in raw_messages(log_path):
        seen.setdefault(channel.topic, []).append(message.sequence)
    assert all(numbers == list(range(len(numbers))) for numbers in seen.values())


def refuse(constant):
    pytest.fail(f"{constant} is no JSON")


def test_every_json_message_is_strict_and_fits_its_own_schema(log_path):
    checked, validators = 0, {}
    for schema, channel, message in raw_messages(log_path):
        if channel.message_encoding != "json":
            continue
        decoded = json.loads(message.data, parse_constant=refuse)
        if schema.id not in validators:
            strict = json.loads(schema.data) | {"additionalProperties": False}
            jsonschema.Draft202012Validator.check_schema(strict)
            validators[schema.id] = jsonschema.Draft202012Validator(strict)
        validators[schema.id].validate(decoded)
        checked += 1
    assert checked > 1000


def test_json_schemas_use_only_what_viewers_parse(log_path):
    def look(schema, where):
        assert isinstance(schema["type"], str), where
        assert not {"$ref", "anyOf", "oneOf"} & set(schema), where
        if schema["type"] == "array":
            assert schema["items"]["type"] != "array", where
            look(schema["items"], f"{where}[]")
        if schema["type"] == "object":
            for key, value in schema["properties"].items():
                look(value, f"{where}.{key}")

    with log_path.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    found = [s for s in summary.schemas.values() if s.encoding == "jsonschema"]
    assert found
    for schema in found:
        look(json.loads(schema.data), schema.name)


def test_the_same_run_gives_the_same_bytes(tmp_path, log_path, dodecapod, verdict):
    again = tmp_path / "again.mcap"
    write_log(again, dodecapod, verdict, scene=SCENE, metadata={"seed": "7"}, start_time_ns=START_NS)
    assert again.read_bytes() == log_path.read_bytes()


def test_a_failure_while_writing_leaves_no_file_and_keeps_the_old_one(tmp_path, dodecapod, verdict, monkeypatch):
    path = tmp_path / "run.mcap"
    path.write_bytes(b"an older log")
    monkeypatch.setattr("mcap.writer.Writer.finish", lambda self: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        write_log(path, dodecapod, verdict)
    assert path.read_bytes() == b"an older log"
    assert [p.name for p in tmp_path.iterdir()] == ["run.mcap"]


def test_a_number_that_is_not_finite_is_refused_rather_than_written(tmp_path, dodecapod, verdict):
    torn = replace(verdict.trace, normal_force=np.full_like(verdict.trace.normal_force, np.nan))
    with pytest.raises(ValueError, match="JSON"):
        write_log(tmp_path / "run.mcap", dodecapod, replace(verdict, trace=torn))
    assert not list(tmp_path.iterdir())


def test_a_folder_that_cannot_be_written_is_bad_input(tmp_path, dodecapod, verdict):
    (tmp_path / "file").write_text("in the folder's place")
    with pytest.raises(InputError) as caught:
        write_log(tmp_path / "file" / "run.mcap", dodecapod, verdict)
    assert caught.value.problems[0].expected == "a file that can be written"


def test_a_log_without_compression_and_at_another_rate_is_read_like_any(tmp_path, dodecapod, verdict):
    path = tmp_path / "run.mcap"
    McapRecorder(rate_hz=10.0, scene_hz=5.0, compression="none").write(path, dodecapod, verdict)
    topics = read_run(path).topics
    assert topics["/tf"] == int(10 * verdict.timeline.duration) + 1
    assert topics["/viz/support"] == int(5 * verdict.timeline.duration) + 1


@pytest.mark.parametrize("setting", [{"rate_hz": 0.0}, {"scene_hz": -1.0}, {"rate_hz": float("nan")}])
def test_a_rate_that_is_none_is_refused(setting):
    with pytest.raises(ValueError, match="is a rate above 0"):
        McapRecorder(**setting)


@pytest.mark.parametrize("damage", ["cut", "flipped", "text"])
def test_a_damaged_log_is_bad_input(tmp_path, log_path, damage):
    data = bytearray(log_path.read_bytes())
    if damage == "flipped":
        data[len(data) // 2] ^= 0xFF
    path = tmp_path / "run.mcap"
    path.write_bytes({"cut": bytes(data[: len(data) // 2]), "flipped": bytes(data), "text": b"no log"}[damage])
    with pytest.raises(InputError, match="cannot be read"):
        read_run(path)


def test_a_log_that_is_not_there_is_bad_input(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        read_run(tmp_path / "run.mcap")
