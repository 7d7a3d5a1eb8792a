"""Segments laid one after the other: where they lie, what is repeated, and how a turn comes around."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.timeline import place
from gaitforge.motion.timeline_build import build_timeline
from gaitforge.robot.model import RobotModel


def test_entries_follow_without_gaps_and_begin_at_the_origin(
    hexapod: RobotModel, start: MotionPlan, tripod: MotionPlan, change: MotionPlan, penta: MotionPlan
) -> None:
    run = build_timeline(hexapod, [(start, 1), (tripod, 3), (change, 1), (penta, 2)])
    ends = np.cumsum([start.duration, 3 * tripod.duration, change.duration, 2 * penta.duration])
    assert [e.end for e in run.entries] == pytest.approx(ends)
    assert [e.start for e in run.entries] == pytest.approx([0.0, *ends[:-1]])
    assert run.duration == pytest.approx(ends[-1])
    assert run.sample([0.0]).base_poses[0, [0, 1, 5]] == pytest.approx([0, 0, 0], abs=1e-12)
    final = run.sample([run.duration]).base_poses[0]
    way = sum(
        n * (p.base_poses[-1, 0] - p.base_poses[0, 0]) for p, n in ((start, 1), (tripod, 3), (change, 1), (penta, 2))
    )
    assert final[0] == pytest.approx(way, abs=2e-3)


def test_a_sample_knows_its_segment_cycle_column_and_contact(
    hexapod: RobotModel, start: MotionPlan, tripod: MotionPlan
) -> None:
    run = build_timeline(hexapod, [(start, 1), (tripod, 2)])
    times = [0.1, start.duration, start.duration + 0.9, start.duration + 2.0, start.duration + 3.99, run.duration]
    motion = run.sample(times)
    assert motion.segment.tolist() == [0, 1, 1, 1, 1, 1]
    assert motion.cycle.tolist() == [0, 0, 0, 1, 1, 1]
    assert motion.column.tolist() == [0, 0, 5, 0, 11, 11]
    for segment, column, contact in zip(motion.segment, motion.column, motion.contact, strict=True):
        assert (contact == (start, tripod)[segment].pattern.contact[:, column]).all()
    assert motion.joint_positions[2] == pytest.approx(tripod(0.9))
    assert motion.joint_velocities[2] == pytest.approx(tripod.joint_spline(0.9, 1))
    assert motion.joint_positions[2] == pytest.approx(run.sample([start.duration + 2.9]).joint_positions[0])


def test_each_cycle_carries_the_body_on(hexapod: RobotModel, sideways: MotionPlan) -> None:
    run = build_timeline(hexapod, [(sideways, 4)])
    poses = run.sample(np.arange(4) * 2.0 + 0.7).base_poses
    assert np.diff(poses, axis=0) == pytest.approx(np.tile([0, 0.128, 0, 0, 0, 0], (3, 1)), abs=1e-9)


def test_a_turning_gait_comes_around_its_circle(hexapod: RobotModel, turning: MotionPlan) -> None:
    """As many cycles as make a full turn end where they began; every base pose keeps its distance to the centre."""
    cycles = 24
    yaw = 2 * np.pi / cycles / turning.duration
    slower = replace(turning, command=replace(turning.command, yaw_rate=yaw))
    # the same motion, bent to a turn of 2π / 24 a cycle: yaw and place of the last pose say how it repeats
    spokes = turning.base_poses.copy()
    spokes[:, 5] += (yaw - turning.command.yaw_rate) * turning.times
    run = build_timeline(hexapod, [(replace(slower, base_poses=spokes), cycles)])
    times = np.linspace(0.0, run.duration, cycles * 5 + 1)
    poses = run.sample(times).base_poses
    assert poses[-1, :5] == pytest.approx(poses[0, :5], abs=1e-6)
    assert poses[-1, 5] - poses[0, 5] == pytest.approx(2 * np.pi)
    for phase in range(5):
        ring = poses[phase:-1:5, :2]
        centre = ring.mean(axis=0)
        distances = np.linalg.norm(ring - centre, axis=1)
        assert distances == pytest.approx(np.full(cycles, distances.mean()), abs=1e-6)


def test_the_base_does_not_jump_between_the_cycles_of_a_turn(hexapod: RobotModel, turning: MotionPlan) -> None:
    run, h = build_timeline(hexapod, [(turning, 5)]), 1e-6
    for n in range(1, 5):
        seam = n * turning.duration
        poses = run.sample([seam - 2 * h, seam - h, seam + h, seam + 2 * h]).base_poses
        assert poses[2] - poses[1] == pytest.approx(np.zeros(6), abs=1e-5)
        assert (poses[1] - poses[0]) / h == pytest.approx((poses[3] - poses[2]) / h, abs=2e-4)


def test_a_gait_begins_where_a_turn_has_ended_and_heads_that_way(
    hexapod: RobotModel, turning: MotionPlan, tripod: MotionPlan
) -> None:
    run = build_timeline(hexapod, [(turning, 3), (tripod, 1)])
    before, after = run.sample([run.entries[1].start - 1e-9, run.entries[1].start + 1e-9]).base_poses
    assert after[[0, 1, 5]] == pytest.approx(before[[0, 1, 5]], abs=1e-6)
    way = run.sample([run.duration]).base_poses[0, :2] - after[:2]
    heading = after[5] - tripod.base_poses[0, 5]
    assert way == pytest.approx(0.128 * np.array([np.cos(heading), np.sin(heading)]), abs=1e-9)


def test_feet_in_stance_stay_in_the_world_while_the_robot_turns(hexapod: RobotModel, turning: MotionPlan) -> None:
    """Over the seam of two cycles, by Pinocchio's feet of the executed motion: they roll a few millimetres."""
    run = build_timeline(hexapod, [(turning, 3)])
    times = np.linspace(0.0, run.duration, 721)
    motion = run.sample(times)
    feet = np.array(
        [hexapod.foot_positions(b, q) for b, q in zip(motion.base_poses, motion.joint_positions, strict=True)]
    )
    for i in range(6):
        begin = None
        for k, stance in enumerate(motion.contact[:, i]):
            begin = (k if begin is None else begin) if stance else None
            if stance:
                assert np.linalg.norm(feet[k, i, :2] - feet[begin, i, :2]) < 0.012


def test_placing_poses_is_a_planar_rigid_motion() -> None:
    rng = np.random.default_rng(0)
    poses, origin = rng.normal(size=(10, 6)), np.array([0.4, -0.7, 1.2])
    placed = place(poses, origin)
    turn = np.array([[np.cos(1.2), -np.sin(1.2)], [np.sin(1.2), np.cos(1.2)]])
    assert placed[:, :2] == pytest.approx(poses[:, :2] @ turn.T + origin[:2])
    assert placed[:, 2:5] == pytest.approx(poses[:, 2:5])
    assert placed[:, 5] == pytest.approx(poses[:, 5] + 1.2)
