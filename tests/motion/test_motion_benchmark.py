"""The cases that the motion benchmark measures."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.motion import FAST, hot
from benchmarks.motion_cases import many_limbs, random_gaits, sized


def test_a_body_is_as_long_as_its_legs_need(tmp_path: Path) -> None:
    robot = many_limbs(8, tmp_path)
    assert robot.limb_names == ("L1", "L2", "L3", "L4", "R1", "R2", "R3", "R4")
    measured = hot(sized(robot, 8), FAST, repeats=1)
    assert measured.solution.solved
    assert measured.total == pytest.approx(measured.build + measured.solve + measured.unpack)
    assert sum(measured.parts.values()) == pytest.approx(measured.solve, rel=0.2, abs=2.0)


def test_random_gaits_are_the_same_for_the_same_seed() -> None:
    one, two = ([(g.robot, g.limbs, g.pattern, g.command) for g in random_gaits(2, seed=3)] for _ in range(2))
    assert one == two
    assert one != [(g.robot, g.limbs, g.pattern, g.command) for g in random_gaits(2, seed=4)]
