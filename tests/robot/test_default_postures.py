"""Postures of robots whose file gives none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import qmc

from gaitforge.robot.limbs import Foot
from gaitforge.robot.posture import Chain, sampled
from gaitforge.robot.tree import Joint


def chain() -> Chain:
    rng = np.random.default_rng(5)
    joints = []
    for n in range(4):
        origin = np.eye(4)
        origin[:3, :3] = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        origin[:3, :3] *= np.linalg.det(origin[:3, :3])
        origin[:3, 3] = rng.normal(0.0, 0.1, 3)
        axis = rng.normal(size=3)
        joints.append(Joint(f"j{n}", "revolute", f"l{n}", f"l{n + 1}", origin, tuple(axis / np.linalg.norm(axis))))
    return Chain(tuple(joints), Foot("l4", (0.02, -0.01, 0.15), 0.02))


def test_the_slope_of_a_chain_is_what_finite_differences_find() -> None:
    limb, q = chain(), np.array([0.3, -0.8, 1.1, 0.2])
    steps = 1e-6 * np.eye(4)
    differences = np.stack([(limb.tip(q + d) - limb.tip(q - d)) / 2e-6 for d in steps], axis=1)
    assert limb.jacobian(q) == pytest.approx(differences, abs=1e-9)


def test_sampled_postures_are_scipys_halton_points_between_the_limits() -> None:
    limb = Chain(tuple(replace(j, lower=-0.5 - k, upper=1.0 + k) for k, j in enumerate(chain().joints)), chain().foot)
    expected = limb.lower + qmc.Halton(4, scramble=False).random(200) * (limb.upper - limb.lower)
    assert sampled(limb, 200) == pytest.approx(expected, abs=1e-15)


def test_many_tips_at_once_are_the_tips_one_by_one() -> None:
    limb, many = chain(), np.random.default_rng(0).uniform(-2.0, 2.0, (3, 5, 4))
    one_by_one = [[limb.tip(q) for q in row] for row in many]
    assert np.array_equal(limb.tip(many), one_by_one)
