"""Transitions and stands meet their neighbours: positions and velocities go on across every seam."""

from __future__ import annotations

import numpy as np
import pytest

import gaitforge as gf
from gaitforge.errors import InputError
from gaitforge.motion.constraints import Progress
from gaitforge.motion.plan import Command, MotionPlan
from gaitforge.motion.state import com_velocity, gait_state
from gaitforge.motion.timeline import Timeline
from gaitforge.motion.timeline_build import build_timeline
from gaitforge.motion.transition import mean_command
from gaitforge.robot.model import RobotModel
from tests.motion.conftest import TUCKED

SEAM = 1e-6


@pytest.fixture(scope="module")
def run(
    hexapod: RobotModel, start: MotionPlan, tripod: MotionPlan, change: MotionPlan, penta: MotionPlan, stop: MotionPlan
) -> Timeline:
    return build_timeline(hexapod, [(start, 1), (tripod, 2), (change, 1), (penta, 2), (stop, 1)])


def seams(run: Timeline) -> list[float]:
    """Times at which one entry, or one cycle of an entry, ends and another begins [s]."""
    return [e.start + n * e.plan.duration for e in run.entries for n in range(e.cycles)][1:]


def test_executed_positions_and_velocities_do_not_jump_at_any_seam(run: Timeline) -> None:
    tiny = 1e-8
    times = np.array(seams(run))
    assert len(times) == 6
    before, after = run.sample(times - tiny), run.sample(times + tiny)
    assert (before.segment != after.segment).sum() == 4
    assert (before.cycle != after.cycle).sum() >= 2
    assert np.abs(after.joint_positions - before.joint_positions).max() < SEAM
    assert np.abs(after.joint_velocities - before.joint_velocities).max() < SEAM
    assert np.abs(after.base_poses - before.base_poses).max() < SEAM


def test_the_base_goes_on_at_its_velocity_across_every_seam(run: Timeline) -> None:
    h = 1e-5
    for t in seams(run):
        poses = run.sample([t - 2 * h, t - h, t + h, t + 2 * h]).base_poses
        assert (poses[1] - poses[0]) / h == pytest.approx((poses[3] - poses[2]) / h, abs=2e-4)


def test_the_splines_themselves_meet_exactly(
    start: MotionPlan, tripod: MotionPlan, change: MotionPlan, penta: MotionPlan, stop: MotionPlan
) -> None:
    for one, other in ((start, tripod), (tripod, change), (change, penta), (penta, stop)):
        for derivative in (0, 1):
            end, begin = one.joint_spline(one.duration, derivative), other.joint_spline(0.0, derivative)
            assert end == pytest.approx(begin, abs=SEAM)
        end, begin = one.base_spline(one.duration, 1), other.base_spline(0.0, 1)
        assert end == pytest.approx(begin, abs=SEAM), "straight gaits: no turn between the frames"
        assert one.base_spline(one.duration)[2:] == pytest.approx(other.base_spline(0.0)[2:], abs=SEAM)


def test_joint_velocities_of_a_gaits_end_state_are_those_of_differences(
    hexapod: RobotModel, turning: MotionPlan
) -> None:
    state, h = gait_state(hexapod, turning), 1e-5
    around = turning([turning.duration - h, h])
    assert state.joint_velocity == pytest.approx((around[1] - around[0]) / (2 * h), abs=1e-4)
    com = [hexapod.center_of_mass(turning.base_spline(t), turning(t)) for t in (0.0, h)]
    assert com_velocity(hexapod, turning, 0.0) == pytest.approx((com[1] - com[0]) / h, abs=1e-4)


def test_a_state_turned_back_is_the_same_state_seen_in_another_frame(hexapod: RobotModel, turning: MotionPlan) -> None:
    plain, turned = gait_state(hexapod, turning), gait_state(hexapod, turning, yaw=0.7)
    assert turned.base[5] - plain.base[5] == pytest.approx(0.7)
    for name in ("base_velocity", "com_velocity"):
        one, other = getattr(plain, name), getattr(turned, name)
        assert np.hypot(*one[:2]) == pytest.approx(np.hypot(*other[:2]))
        assert np.arctan2(other[1], other[0]) - np.arctan2(one[1], one[0]) == pytest.approx(0.7)
        assert other[2:] == pytest.approx(one[2:])


def test_a_transition_covers_the_share_of_the_commanded_way(change: MotionPlan) -> None:
    way = change.base_poses[-1, 0] - change.base_poses[0, 0]
    assert way >= Progress().share * 0.064 * change.duration - 1e-6
    assert change.duration == pytest.approx(11 * 0.125)


def test_between_two_commands_a_transition_is_asked_for_their_mean() -> None:
    mean = mean_command(Command(0.06, 0.0, 0.1), Command(0.08, np.pi / 2, 0.3))
    assert mean.speed * np.array([np.cos(mean.heading), np.sin(mean.heading)]) == pytest.approx([0.03, 0.04])
    assert mean.yaw_rate == pytest.approx(0.2)


def test_a_limb_that_stops_walking_reaches_its_posture_at_rest(
    hexapod: RobotModel, change: MotionPlan, penta: MotionPlan
) -> None:
    rows = hexapod.joint_indices(hexapod.limb("R1"))
    assert change.joint_positions[rows, -1] == pytest.approx(TUCKED, abs=1e-9)
    assert change.joint_spline(change.duration, 1)[rows] == pytest.approx(np.zeros(3), abs=1e-9)
    assert change.roles == penta.roles == {"R1": gf.Held(TUCKED)}
    away = np.abs(change.joint_positions[rows, 0] - TUCKED).max()
    assert away > 0.3, "it had to get there"


def test_a_start_begins_at_rest_and_a_stop_ends_at_rest(start: MotionPlan, stop: MotionPlan) -> None:
    for plan, t in ((start, 0.0), (stop, stop.duration)):
        assert plan.joint_spline(t, 1) == pytest.approx(np.zeros(plan.joint_positions.shape[0]), abs=1e-12)
        assert plan.base_spline(t, 1) == pytest.approx(np.zeros(6), abs=1e-12)
    assert start.kind == stop.kind == "stand"


def test_a_start_goes_ahead_and_does_not_swing_back_first(start: MotionPlan) -> None:
    ahead = np.diff(start.base_spline(np.linspace(0.0, start.duration, 101))[:, 0])
    assert ahead.min() > -1e-4
    assert 0.015 < ahead.sum() < 0.06, "about half of what the gait covers in the same time"


def test_feet_on_the_ground_at_a_seam_stay_where_they_are(
    hexapod: RobotModel, tripod: MotionPlan, change: MotionPlan
) -> None:
    """The last feet of the gait, seen from its end pose, are the first feet of the transition."""
    end = hexapod.foot_positions(tripod.base_poses[-1], tripod.joint_positions[:, -1])
    begin = hexapod.foot_positions(change.base_poses[0], change.joint_positions[:, 0])
    shift = change.base_poses[0, :3] - tripod.base_poses[-1, :3]
    assert begin - shift == pytest.approx(end, abs=1e-6)


def test_a_role_for_a_limb_that_does_not_exist_is_refused(
    hexapod: RobotModel, tripod: MotionPlan, penta: MotionPlan
) -> None:
    with pytest.raises(InputError, match="expected one of L1, L2, L3, R1, R2, R3"):
        gf.plan_transition(hexapod, tripod, penta, pattern=tripod.pattern, roles={"leg": gf.Held()})
