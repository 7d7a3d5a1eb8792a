"""Slip: the path of the contact point with rolling taken out, by hand-computed cases."""

import numpy as np
import pytest
from walkers import HEIGHT, RADIUS, posture, walker

from gaitforge.robot.run_kinematics import run_kinematics
from gaitforge.verify.checks.contact import lasting_minimum, slip_per_stance

ROBOT = walker(3)
STILL = np.zeros((1, 18))
AT_REST = np.array([[0.0, 0.0, HEIGHT, 0.0, 0.0, 0.0]])


def contact_velocity(base_twist: list[float], joint_rates: np.ndarray = STILL) -> np.ndarray:
    twist = np.array([base_twist], dtype=float)
    return run_kinematics(ROBOT, AT_REST, twist, posture(3)[None], joint_rates).contact_velocity[0]


def test_a_robot_that_slides_as_a_whole_slips_at_its_own_speed() -> None:
    np.testing.assert_allclose(contact_velocity([0.1, 0.02, 0, 0, 0, 0]), [[0.1, 0.02, 0.0]] * 6, atol=1e-12)


def test_a_body_that_turns_about_a_contact_point_does_not_slip_there() -> None:
    foot = ROBOT.foot_positions(AT_REST[0], posture(3))[0]
    contact = foot - [0.0, 0.0, RADIUS]
    omega = np.array([0.3, -0.5, 0.7])
    linear = np.cross(omega, AT_REST[0, :3] - contact)  # of base_link's origin
    assert np.abs(contact_velocity([*linear, *omega])[0]).max() < 1e-12


def test_a_sphere_that_rolls_moves_its_centre_by_radius_times_angle_and_does_not_slip() -> None:
    base, dt = AT_REST.copy(), 1e-6
    omega = np.array([0.0, 0.4, 0.0])
    foot = ROBOT.foot_positions(base[0], posture(3))[2]
    rolled = RADIUS * np.cross(omega, [0.0, 0.0, 1.0])  # velocity of the centre: r ω × ẑ
    linear = rolled + np.cross(omega, base[0, :3] - foot)
    base[0, :3] += linear * dt
    base[0, 4] += omega[1] * dt
    moved = ROBOT.foot_positions(base[0], posture(3))[2] - foot
    np.testing.assert_allclose(moved / dt, rolled, atol=1e-6)
    assert np.abs(contact_velocity([*linear, *omega])[2]).max() < 1e-12


def test_joint_rates_move_the_contact_point_as_finite_differences_of_the_foot_say() -> None:
    rates, dt = np.random.default_rng(0).normal(size=(1, 18)), 1e-6
    q = posture(3)
    before = ROBOT.link_pose("R2_tibia", AT_REST[0], q)
    after = ROBOT.link_pose("R2_tibia", AT_REST[0], q + rates[0] * dt)
    lowest = ROBOT.foot_positions(AT_REST[0], q)[4] - [0.0, 0.0, RADIUS]
    material = np.linalg.inv(before) @ [*lowest, 1.0]  # the same grain of the foot's material
    expected = ((after - before) @ material)[:3] / dt
    np.testing.assert_allclose(contact_velocity([0.0] * 6, rates)[4], expected, atol=1e-5)


def test_slip_is_summed_per_stance_and_split_in_the_middle_of_the_swing() -> None:
    planned = np.array([1, 1, 1, 0, 0, 0, 0, 1, 1, 1], dtype=bool)
    speed = np.array([1, 1, 1, 1, 0, 0, 2, 1, 1, 1], dtype=float)
    assert slip_per_stance(speed, planned, 0.1) == pytest.approx(0.5)  # 4 before, 5 after


def test_a_foot_that_never_swings_has_one_stance() -> None:
    assert slip_per_stance(np.ones(10), np.ones(10, dtype=bool), 0.1) == pytest.approx(1.0)


def test_the_lasting_minimum_forgives_one_row_and_not_two() -> None:
    values = np.array([5.0, -1.0, 5.0, 2.0, 3.0])
    assert lasting_minimum(values, 2) == 3.0
    assert lasting_minimum(values, 1) == -1.0
