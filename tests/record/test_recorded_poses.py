"""A log alone is enough to draw its run again."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from run_by_hand import SCENE

from gaitforge.record import write_log
from gaitforge.record.poses import recorded_poses
from gaitforge.record.reader import read_run
from gaitforge.robot.rotation import quaternions
from gaitforge.task.scene import Scene, SceneObject
from gaitforge.verify.pictures import View, frames

CRATE = SceneObject("crate", "box", (1.0, 0.0, 0.1), size=(0.2, 0.3, 0.1), mass=0.5)


def test_poses_come_back_as_they_were_simulated(log, verdict):
    poses, trace = recorded_poses(log), verdict.trace
    rows = np.searchsorted(trace.times, poses.times - 1e-6)
    assert np.abs(trace.times[rows] - poses.times).max() < 1e-8
    assert np.allclose(np.diff(poses.times[:20]), 0.02, atol=5e-3)
    assert np.allclose(poses.base_poses, trace.base_poses[rows], atol=1e-9)
    assert np.allclose(poses.joint_positions, trace.joint_positions[rows], atol=1e-12)
    assert poses.feet.shape == (len(rows), 12, 3)
    assert np.allclose(poses.feet[7, 3], log.robot.foot_positions(poses.base_poses[7], poses.joint_positions[7])[3])
    assert poses.objects == {}


def test_loads_are_where_they_were_last_drawn(dodecapod, verdict, tmp_path):
    trace = verdict.trace
    box = np.tile([0.0, 6.0, 7.0, *quaternions([0.1, 0.2, 0.3])], (len(trace.times), 1))
    box[:, 0] = trace.times
    laden = replace(verdict, trace=replace(trace, objects={"crate": box}))
    scene = Scene((*SCENE.objects, CRATE))
    write_log(tmp_path / "run.mcap", dodecapod, laden, scene=scene)
    poses = recorded_poses(read_run(tmp_path / "run.mcap"))
    behind = poses.times - poses.objects["crate"][:, 0]
    assert behind.min() > -1e-8
    assert 0.01 < behind.max() < 1.0 / 25 + 1e-8
    assert np.allclose(poses.objects["crate"][5, 1:], box[0, 1:], atol=1e-12)


def test_a_log_is_drawn_as_its_trace_is(log, verdict):
    poses = recorded_poses(log)
    times = (poses.times[[10, 60]] - 1e-6).tolist()
    drawn, known = (
        np.array([p.copy() for p in frames(log.robot, what, SCENE, times, (128, 72), View(distance=2.0))], dtype=int)
        for what in (poses, verdict.trace)
    )
    assert drawn.shape == (2, 72, 128, 3)
    assert np.abs(drawn[0] - drawn[1]).mean() > 0.5
    assert np.abs(drawn - known).mean() < 0.01
