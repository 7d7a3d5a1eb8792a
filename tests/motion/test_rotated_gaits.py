"""A gait begun later is the same gait."""

import numpy as np
import pytest

import gaitforge as gf
from gaitforge.motion.rotate import rotated
from gaitforge.motion.state import gait_state
from gaitforge.motion.timeline import Entry, Timeline
from gaitforge.motion.timeline_build import build_timeline


@pytest.fixture(scope="module")
def turning():
    robot = gf.load_robot("hexapod")
    pattern = gf.synthesize_gait_pattern(robot, columns=12)
    return robot, gf.plan_gait(robot, pattern, speed=0.05, yaw_rate=0.1, heading=0.3, samples_per_column=2)


def sampled(robot, plan, times):
    entry = Entry(plan, 4, 0.0, np.zeros(3))
    return Timeline(robot, (entry,)).sample(times)


@pytest.mark.parametrize("columns", [0, 1, 5, 11, 12, 17, -2])
def test_joints_and_contacts_are_those_of_the_gait_so_much_later(turning, columns):
    robot, gait = turning
    later = rotated(gait, columns)
    shift = (columns % 12) * gait.duration / 12
    times = np.linspace(0.0, 2.9, 59) + 0.003
    ours, whole = sampled(robot, later, times), sampled(robot, gait, times + shift)
    np.testing.assert_allclose(ours.joint_positions, whole.joint_positions, atol=1e-9)
    np.testing.assert_array_equal(ours.contact, whole.contact)


@pytest.mark.parametrize("columns", [1, 7])
def test_the_body_goes_the_same_way_from_there(turning, columns):
    robot, gait = turning
    later = rotated(gait, columns)
    times = later.times
    whole = sampled(robot, gait, times + columns * gait.duration / 12).base_poses
    timeline = build_timeline(robot, [(later, 1)])
    ours = timeline.sample(times[:-1]).base_poses
    yaw = whole[0, 5] - ours[0, 5]
    c, s = np.cos(yaw), np.sin(yaw)
    turned = (ours[:, :2] - ours[0, :2]) @ np.array([[c, s], [-s, c]]) + whole[0, :2]
    np.testing.assert_allclose(turned, whole[:-1, :2], atol=2e-4)
    np.testing.assert_allclose(ours[:, 2:5], whole[:-1, 2:5], atol=2e-4)
    np.testing.assert_allclose(ours[:, 5] + yaw, whole[:-1, 5], atol=2e-4)


@pytest.mark.parametrize("columns", [0, 1, 7])
def test_feet_and_centre_of_mass_are_where_the_joints_put_them(turning, columns):
    robot, gait = turning
    later = rotated(gait, columns)
    for k in (0, 3, len(later.times) - 1):
        joints, base = later.joint_positions[:, k], later.base_poses[k]
        np.testing.assert_allclose(robot.foot_positions(base, joints), later.feet[k], atol=1e-9)
        np.testing.assert_allclose(robot.center_of_mass(base, joints), later.com[k], atol=1e-9)


def test_begun_a_cycle_later_nothing_changes(turning):
    robot, gait = turning
    later = rotated(gait, 12)
    np.testing.assert_allclose(later.base_poses, gait.base_poses, atol=1e-12)
    np.testing.assert_allclose(gait_state(robot, later).com_velocity, gait_state(robot, gait).com_velocity, atol=1e-9)


def test_a_stand_is_refused(turning):
    robot, gait = turning
    with pytest.raises(ValueError, match="stand"):
        rotated(gf.plan_start(robot, gait), 1)
