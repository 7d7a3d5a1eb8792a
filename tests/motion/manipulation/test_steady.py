"""Walking with a load: what its options ask for, and what that does to the gait."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion.costs.pace import Pace
from gaitforge.motion.costs.smoothness import Smoothness
from gaitforge.motion.gait import plan_gait
from gaitforge.motion.manipulation.footing import under_load
from gaitforge.motion.manipulation.pick_place import Carried, carry
from gaitforge.motion.manipulation.steady import HIGHER, STEADY, steadied
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import MotionPlan
from gaitforge.robot.model import RobotModel
from gaitforge.task.handling import Pick
from gaitforge.task.scene import SceneObject

BOX = SceneObject("box", "box", (0.33, 0.0, 0.06), size=(0.16, 0.25, 0.12), mass=0.5)
CRAWL = {"L1": "0" * 12, "L2": "100111111111", "L3": "111111111100", "R1": "0" * 12, "R2": "111111100111",
         "R3": "111100111111"}  # fmt: skip


@pytest.fixture(scope="module")
def carried(hexapod: RobotModel) -> Carried:
    return carry(hexapod, BOX, Pick("box", ("L1", "R1")), (0.0, 0.0, 0.0))


def _crawl(robot: RobotModel, carried: Carried, options: MotionOptions) -> MotionPlan:
    held = robot.nominal.held_posture.copy()
    for name, q in carried.joints.items():
        held[robot.joint_indices(robot.limb(name))] = q
    grasping = replace(robot, nominal=replace(robot.nominal, held_posture=held)).carrying(carried.load)
    stance = under_load(grasping, ("L2", "L3", "R2", "R3")).nominal
    standing = replace(grasping, nominal=stance)
    return plan_gait(standing, FootfallPattern.from_rows(CRAWL), roles=carried.roles, options=options)


def test_a_load_asks_for_a_steady_body_and_higher_steps(hexapod: RobotModel) -> None:
    plain = MotionOptions()
    laden = steadied(plain, hexapod)
    assert laden.step_height == pytest.approx(HIGHER * hexapod.nominal.step_height)
    (smooth,) = (c.position for c in laden.costs if isinstance(c, Smoothness))
    (before,) = (c.position for c in plain.costs if isinstance(c, Smoothness))
    assert smooth == STEADY * before
    assert sum(isinstance(c, Pace) for c in laden.costs) == 1


def test_a_step_height_and_a_pace_that_were_asked_for_stay(hexapod: RobotModel) -> None:
    asked = MotionOptions(step_height=0.02, costs=(*MotionOptions().costs, Pace(3.0)))
    laden = steadied(asked, hexapod)
    assert laden.step_height == 0.02
    assert [c.weight for c in laden.costs if isinstance(c, Pace)] == [3.0]


def test_a_body_that_carries_goes_ahead_all_the_time(hexapod: RobotModel, carried: Carried) -> None:
    plain = MotionOptions(explain=False)
    speeds = []
    for options in (plain, steadied(plain, hexapod)):
        gait = _crawl(hexapod, carried, options)
        speeds.append(gait.base_spline(np.linspace(0.0, gait.duration, 241), 1)[:, 0])
    hurrying, steady = speeds
    assert steady.min() > 0.0
    assert np.ptp(steady) < 0.75 * np.ptp(hurrying)
