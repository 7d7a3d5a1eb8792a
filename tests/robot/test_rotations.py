"""Angles, matrices and quaternions against Pinocchio's."""

import numpy as np
import pinocchio
import pytest

from gaitforge.robot.rotation import matrices, matrices_of_quaternions, poses_of, quaternions, rpy_of_matrices

ANGLES = np.random.default_rng(3).uniform(-1.5, 1.5, (50, 3))


def test_matrices_are_those_of_pinocchio() -> None:
    expected = [pinocchio.rpy.rpyToMatrix(*a) for a in ANGLES]
    np.testing.assert_allclose(matrices(ANGLES), expected, atol=1e-14)


def test_angles_come_back_from_matrices_and_from_quaternions() -> None:
    np.testing.assert_allclose(rpy_of_matrices(matrices(ANGLES)), ANGLES, atol=1e-12)
    np.testing.assert_allclose(matrices_of_quaternions(quaternions(ANGLES)), matrices(ANGLES), atol=1e-14)


def test_yaw_goes_on_past_half_a_turn() -> None:
    yaw = np.linspace(0.0, 7.0, 50)
    R = matrices(np.stack([0 * yaw, 0 * yaw, yaw], axis=1))
    assert poses_of(np.zeros((50, 3)), R)[-1, 5] == pytest.approx(7.0)
