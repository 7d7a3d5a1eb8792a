"""What goes into a log comes back: C, P, the timeline, the robot, the scene."""

from __future__ import annotations

import hashlib
from dataclasses import replace

import numpy as np
import pytest
from run_by_hand import SCENE, make_verdict

from gaitforge.errors import InputError
from gaitforge.motion.timeline import Timeline
from gaitforge.record import plan_archive, write_log, write_plan_npz
from gaitforge.record.archive import archive_bytes, read_archive
from gaitforge.record.reader import read_run
from gaitforge.record.rebuild import timeline_from_arrays
from gaitforge.record.values import dumps, loads
from gaitforge.robot.load import load_robot
from gaitforge.task.roles import Tool
from gaitforge.verify.verify import verify_timeline


def test_c_and_p_come_back_bit_for_bit(log, verdict):
    assert len(log.segments) == len(verdict.timeline.entries)
    for segment, entry in zip(log.segments, verdict.timeline.entries, strict=True):
        assert (segment.name, segment.kind, segment.cycles) == (entry.plan.name, entry.plan.kind, entry.cycles)
        assert segment.pattern.contact.tobytes() == entry.plan.pattern.contact.tobytes()
        assert segment.pattern.contact.dtype == bool
        assert segment.joint_positions.tobytes() == np.ascontiguousarray(entry.plan.joint_positions).tobytes()
        assert segment.joint_positions.shape == entry.plan.joint_positions.shape


def test_the_timeline_of_a_log_executes_the_same_motion(log, verdict):
    times = np.linspace(0.0, verdict.timeline.duration, 1777)
    ours, theirs = verdict.timeline.sample(times), log.timeline.sample(times)
    for name in ("joint_positions", "joint_velocities", "base_poses", "contact", "segment", "cycle", "column"):
        assert np.array_equal(getattr(ours, name), getattr(theirs, name)), name


def test_what_surrounds_the_plans_comes_back_too(log, verdict):
    for ours, theirs in zip(verdict.timeline.entries, log.timeline.entries, strict=True):
        assert ours.plan.roles == theirs.plan.roles
        assert ours.plan.command == theirs.plan.command
        assert ours.plan.relaxed == theirs.plan.relaxed
        assert ours.plan.report.cost == theirs.plan.report.cost
        assert np.array_equal(ours.plan.weights, theirs.plan.weights)
        assert np.array_equal(ours.origin, theirs.origin)
    (ours,), (theirs,) = verdict.timeline.aims, log.timeline.aims
    assert (ours.limb, ours.tool, ours.start, ours.end) == (theirs.limb, theirs.tool, theirs.start, theirs.end)
    assert np.array_equal(ours.target, theirs.target)


def test_the_robot_of_a_log_is_the_robot(log, dodecapod):
    assert log.urdf == log.robot.urdf == dodecapod.urdf
    assert log.robot.limbs == dodecapod.limbs
    assert log.robot.capsules == dodecapod.capsules
    assert [t.name for t in log.robot.tools] == [t.name for t in dodecapod.tools]
    assert np.array_equal(log.robot.nominal.posture, dodecapod.nominal.posture)
    pose, joints = [0.1, 0.2, 0.15, 0.01, 0.02, 0.3], dodecapod.nominal.posture
    assert np.array_equal(log.robot.foot_positions(pose, joints), dodecapod.foot_positions(pose, joints))
    assert log.scene == SCENE


@pytest.mark.parametrize("name", ["hexapod", "quadruped"])
def test_every_robot_survives_json(name):
    robot = load_robot(name)
    assert dumps(loads(dumps(robot))) == dumps(robot)


def test_a_role_keeps_its_target():
    assert loads(dumps({"R2": Tool((1.0, 0.5, 0.25), "body")})) == {"R2": Tool((1.0, 0.5, 0.25), "body")}


def test_a_class_that_a_log_does_not_know_is_refused_by_name(verdict):
    with pytest.raises(TypeError, match="Check is none of the values"):
        dumps(verdict.checks[0])


def test_the_fingerprints_on_plan_segment_are_those_of_c_and_p(log, verdict):
    for (_, message), entry in zip(log.messages("/plan/segment"), verdict.timeline.entries, strict=True):
        c, p = entry.plan.pattern.contact, entry.plan.joint_positions
        rows = bytes(int(v) for row in c for v in row)
        assert message["sha256_C"] == hashlib.sha256(rows).hexdigest()
        assert message["sha256_P"] == hashlib.sha256(p.astype("<f8").tobytes(order="C")).hexdigest()
        assert message["shape_P"] == list(p.shape)
        assert message["contact"] == ["".join(str(int(v)) for v in row) for row in c]


def test_a_plan_that_is_not_the_one_announced_is_found(tmp_path, dodecapod, verdict, monkeypatch):
    path = tmp_path / "run.mcap"
    entries = verdict.timeline.entries
    bent = replace(entries[1].plan, joint_positions=entries[1].plan.joint_positions + 1e-12)
    other = Timeline(dodecapod, (entries[0], replace(entries[1], plan=bent), *entries[2:]), *_rest(verdict.timeline))
    monkeypatch.setattr("gaitforge.record.writer.archive_bytes", lambda timeline: archive_bytes(other))
    write_log(path, dodecapod, verdict)
    with pytest.raises(InputError, match="another P"):
        read_run(path)


def test_plan_npz_is_the_attachment_and_does_not_depend_on_the_clock(tmp_path, log, dodecapod, verdict):
    write_plan_npz(tmp_path / "plan.npz", dodecapod, verdict.timeline)
    data = (tmp_path / "plan.npz").read_bytes()
    assert data == log.attachments["plan.npz"]
    with np.load(tmp_path / "plan.npz") as archive:  # a user's NumPy, without this project
        assert archive["all/C"].shape == (12, 12)
        assert list(archive["joint_names"]) == list(dodecapod.joint_names)
        assert list(archive["limb_names"]) == list(dodecapod.limb_names)
        assert set(archive.files) == set(plan_archive(verdict.timeline))


def test_the_executed_trajectory_of_a_tool_limb_is_written_out(verdict):
    arrays = plan_archive(verdict.timeline)
    rows = [verdict.timeline.robot.joint_names.index(str(n)) for n in arrays["executed/joint_names"]]
    assert rows == sorted({row for row, *_ in verdict.timeline.overrides})
    sampled = verdict.timeline.sample(arrays["executed/times"]).joint_positions[:, rows].T
    assert np.array_equal(arrays["executed/positions"], sampled)
    assert np.allclose(np.diff(arrays["executed/times"]), 1 / 240.0)


def test_plans_of_one_name_are_kept_apart_and_a_plan_that_returns_is_kept_once(dodecapod, verdict):
    stand, gait = verdict.timeline.entries[0], verdict.timeline.entries[1]
    other = replace(gait, plan=replace(gait.plan, joint_positions=gait.plan.joint_positions * 0.5), start=gait.end)
    again = replace(gait, start=other.end)
    timeline = Timeline(dodecapod, (stand, gait, other, again))
    arrays = read_archive(archive_bytes(timeline))
    assert list(arrays["timeline/segment"]) == ["start", "all", "all_2", "all"]
    rebuilt = timeline_from_arrays(dodecapod, arrays)
    assert rebuilt.entries[1].plan is rebuilt.entries[3].plan
    assert np.array_equal(rebuilt.entries[2].plan.joint_positions, other.plan.joint_positions)


def test_a_plan_of_another_robot_is_refused(tmp_path, verdict):
    with pytest.raises(ValueError, match="a timeline of dodecapod for the robot hexapod"):
        write_plan_npz(tmp_path / "plan.npz", load_robot("hexapod"), verdict.timeline)
    assert not list(tmp_path.iterdir())


def _rest(timeline):
    return timeline.aims, timeline.overrides


def test_the_timeline_of_a_log_is_simulated_to_the_same_run_bit_for_bit(tmp_path):
    robot = load_robot("hexapod")
    made = make_verdict(robot)
    entries = made.timeline.entries
    stop = replace(entries[-1], start=entries[0].end)
    timeline = Timeline(robot, (entries[0], stop))
    verdict = verify_timeline(robot, timeline)
    write_log(tmp_path / "run.mcap", robot, verdict)
    log = read_run(tmp_path / "run.mcap")
    again = verify_timeline(log.robot, log.timeline, log.scene)
    assert np.array_equal(again.trace.joint_positions, verdict.trace.joint_positions)
    assert np.array_equal(again.trace.base_poses, verdict.trace.base_poses)
    assert np.array_equal(again.trace.normal_force, verdict.trace.normal_force)
    assert [c.passed for c in again.checks] == [c.passed for c in verdict.checks]
