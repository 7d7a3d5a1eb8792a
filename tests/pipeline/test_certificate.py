"""The certificate against a speed holds against every pattern."""

from __future__ import annotations

import numpy as np
import pytest

from gaitforge.errors import InfeasibleMotion
from gaitforge.motion.limits import fastest_foot, longest_reach
from gaitforge.pipeline.search.certificate import refuse_impossible_speed
from gaitforge.robot.load import load_robot

ROBOTS = ("hexapod", "dodecapod", "quadruped")


@pytest.mark.parametrize("name", ROBOTS)
def test_the_nominal_speed_is_never_refused_and_a_jet_always_is(name: str) -> None:
    robot = load_robot(name)
    refuse_impossible_speed(robot, robot.limb_names, robot.nominal.speed, robot.nominal.duration)
    with pytest.raises(InfeasibleMotion, match="any footfall pattern") as caught:
        refuse_impossible_speed(robot, robot.limb_names, 200.0, robot.nominal.duration)
    assert caught.value.explain["limbs"] == list(robot.limb_names)


@pytest.mark.parametrize("name", ROBOTS)
def test_feet_at_random_postures_stay_within_the_bounds_it_rests_on(name: str) -> None:
    robot = load_robot(name)
    rng = np.random.default_rng(1)
    base = np.zeros(6)
    postures = rng.uniform(robot.lower, robot.upper, (60, len(robot.lower)))
    feet = np.array([robot.foot_positions(base, q) for q in postures])
    h = 1e-6
    for i, limb in enumerate(robot.limbs):
        spread = np.linalg.norm(feet[:, None, i] - feet[None, :, i], axis=-1).max()
        assert spread <= longest_reach(robot, limb)
        fastest = 0.0
        for q, foot in zip(postures, feet[:, i], strict=True):
            signs = rng.choice([-1.0, 1.0], len(q))
            moved = robot.foot_positions(base, q + h * signs * robot.velocity)[i]
            fastest = max(fastest, float(np.linalg.norm(moved - foot)) / h)
        assert fastest <= fastest_foot(robot, limb) * (1 + 1e-4)


def test_some_limb_of_any_pattern_stands_for_the_share_it_says() -> None:
    rng = np.random.default_rng(2)
    for _ in range(200):
        n, m = rng.integers(4, 13), rng.integers(6, 19)
        contact = rng.random((n, m)) < 0.5
        for column in contact.T:
            column[rng.choice(n, 3, replace=False)] = True
        assert contact.mean(axis=1).max() >= 3 / n - 1e-12
