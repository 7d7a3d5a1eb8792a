"""The least that motors are asked for: against statics by hand, and how it changes with friction and motors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.strain import least_strain
from gaitforge.robot.model import RobotModel
from gaitforge.task.roles import Failed
from tests.motion.test_efforts import GRAVITY, held_torques


def by_hand(robot: RobotModel, plan: MotionPlan, k: int) -> float:
    """Three feet without friction: their vertical forces follow from the balance of force and of two moments."""
    stance = np.flatnonzero(plan.pattern.contact[:, k // plan.samples_per_column])
    assert len(stance) == 3
    x, y = plan.feet[k, stance, 0], plan.feet[k, stance, 1]
    weight = robot.mass * GRAVITY
    forces = np.zeros(len(robot.limbs))
    forces[stance] = np.linalg.solve(np.stack([np.ones(3), x, y]), weight * np.array([1.0, *plan.com[k, :2]]))
    torque = held_torques(robot, plan.base_poses[k], plan.joint_positions[:, k], forces)
    limbs = np.concatenate([robot.joint_indices(limb) for limb in robot.limbs])
    return float(np.abs(torque / robot.effort)[limbs].max())


def test_without_friction_three_feet_leave_no_choice(hexapod: RobotModel, tripod: MotionPlan) -> None:
    expected = max(by_hand(hexapod, tripod, k) for k in range(len(tripod.times) - 1))
    assert least_strain(hexapod, tripod, 0.0) == pytest.approx(expected, rel=1e-6)


def test_friction_takes_load_off_the_motors(hexapod: RobotModel, tripod: MotionPlan) -> None:
    asked = [least_strain(hexapod, tripod, friction) for friction in (0.0, 0.2, 0.35, 0.7)]
    assert asked == sorted(asked, reverse=True)
    assert asked[-1] < 0.5 * asked[0]


def test_half_the_effort_is_twice_the_strain(hexapod: RobotModel, tripod: MotionPlan) -> None:
    weak = replace(hexapod, effort=0.5 * hexapod.effort)
    assert least_strain(weak, tripod) == pytest.approx(2.0 * least_strain(hexapod, tripod), rel=1e-6)


def test_two_feet_with_the_weight_beside_them_hold_nothing(hexapod: RobotModel, tripod: MotionPlan) -> None:
    contact = tripod.pattern.contact.copy()
    contact[0] = False  # L1, of one of the two tripods
    lame = replace(tripod, pattern=replace(tripod.pattern, contact=contact))
    assert least_strain(hexapod, lame) == np.inf


def test_a_limp_limb_is_asked_for_nothing(hexapod: RobotModel, tripod: MotionPlan) -> None:
    contact = np.ones_like(tripod.pattern.contact)
    contact[hexapod.limb_names.index("R1")] = False
    standing = replace(tripod, pattern=replace(tripod.pattern, contact=contact))
    posture = tuple(tripod.joint_positions[hexapod.joint_indices(hexapod.limb("R1")), 0].tolist())
    weak = hexapod.effort.copy()
    weak[hexapod.joint_indices(hexapod.limb("R1"))] *= 1e-3
    robot = replace(hexapod, effort=weak)
    held, limp = (replace(standing, roles={"R1": Failed(mode, posture)}) for mode in ("locked", "limp"))
    assert least_strain(robot, held) > 1.0 > least_strain(robot, limp)
