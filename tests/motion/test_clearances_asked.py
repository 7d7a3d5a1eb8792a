"""What bodies that came near each other are asked for: enough to part them, nothing that has no solution."""

from __future__ import annotations

import numpy as np
import pytest

import gaitforge as gf
from gaitforge.motion.bodies import Closest, limb_capsules
from gaitforge.motion.dense import DenseReport
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.remedies import Remedies, misses
from gaitforge.robot.model import RobotModel
from tests.motion.motion_kit import TRIPOD, open_segment

OPTIONS = MotionOptions()
"""A clearance of 4 mm, of which the spline has to keep 2"""


@pytest.fixture(scope="module")
def hexapod() -> RobotModel:
    return gf.load_robot("hexapod")


def seen(robot: RobotModel, gap: float, dip: float = 0.0, sample: int = 3, feet: tuple[int, int] = (0, 1)) -> Closest:
    """Two shins `gap` [m] apart."""
    shins = {c.limb: c for c in limb_capsules(robot)}
    return Closest(sample, shins[feet[0]], shins[feet[1]], np.zeros(3), np.zeros(3), gap, dip)


def asked(robot: RobotModel, *close: Closest) -> dict[tuple[int, float], float]:
    """(sample, gap) → [m] that the rows of the next solve ask for, of a transition that found these."""
    joints = np.zeros(len(robot.joint_names))
    report = DenseReport(joints, joints - 1.0, 0.0, 0.0, 0.0, 0.1, 0.1, close, (), ())
    remedies, segment = Remedies(), open_segment(robot, TRIPOD, "transition")
    assert [m.family for m in misses(segment, OPTIONS, report)] == ["clearance"]
    remedies.answer(segment, OPTIONS, report)
    (family,) = remedies.clearances
    return {(p.sample, p.gap): family.margin + p.dip - p.less for p in family.pairs}


def test_bodies_that_come_too_near_are_parted_by_the_whole_clearance(hexapod: RobotModel) -> None:
    rows = asked(hexapod, seen(hexapod, 0.001), seen(hexapod, -0.002, 0.0005, sample=5))
    assert rows == pytest.approx({(3, 0.001): 0.004, (5, -0.002): 0.0045})


def test_bodies_that_keep_enough_are_asked_for_what_they_have(hexapod: RobotModel) -> None:
    rows = asked(
        hexapod, seen(hexapod, 0.001), seen(hexapod, 0.003, 0.0002, feet=(3, 4)), seen(hexapod, 0.009, feet=(4, 5))
    )
    assert rows == pytest.approx({(3, 0.001): 0.004, (3, 0.003): 0.0032, (3, 0.009): 0.004})


@pytest.mark.parametrize(("given", "wanted"), [(0.0032, 0.0032), (0.001, 0.0023), (0.02, 0.0043)])
def test_bodies_that_a_neighbour_put_down_near_each_other_may_stay_as_near(
    hexapod: RobotModel, given: float, wanted: float
) -> None:
    last = open_segment(hexapod, TRIPOD, "transition").grid.intervals
    rows = asked(hexapod, seen(hexapod, 0.0015, 0.0003), seen(hexapod, given, sample=last))
    assert rows == pytest.approx({(3, 0.0015): wanted})
