"""Limbs and the ground: what is measured, what is asked for, and a gait that lay on a shin without it."""

from __future__ import annotations

import numpy as np
import pytest

import gaitforge as gf
from gaitforge.motion import remedies
from gaitforge.motion.constraints.limb_height import LimbHeight
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import Command
from gaitforge.motion.shins import LowPoint, low_points
from gaitforge.robot.kinematics import evaluate_limbs
from gaitforge.robot.model import RobotModel
from gaitforge.robot.rotation import matrices
from tests.motion.motion_kit import TRIPOD, gait_segment


def cloud(robot: RobotModel, name: str, base: np.ndarray, joints: np.ndarray) -> float:
    """[m] height of the lowest of many points on the capsules of a link, by Pinocchio's frames."""
    rng = np.random.default_rng(0)
    away = rng.normal(size=(4000, 3))
    away /= np.linalg.norm(away, axis=1)[:, None]
    pose = robot.link_pose(name, base, joints)
    heights = []
    for capsule in (c for c in robot.capsules if c.link == name):
        share = rng.random((4000, 1)).round()  # the lowest point is about one of the ends
        points = capsule.a + share * (np.array(capsule.b) - capsule.a) + capsule.radius * away
        heights.append(float((points @ pose[:3, :3].T + pose[:3, 3])[:, 2].min()))
    return min(heights)


def ends(robot: RobotModel, base: np.ndarray, joints: np.ndarray) -> np.ndarray:
    """(C, 2) [m] heights of the lowest points about the ends of the limbs' capsules, by Pinocchio's frames."""
    found = []
    for capsule in (c for c in robot.capsules if any(c.link in limb.links for limb in robot.limbs)):
        pose = robot.link_pose(capsule.link, base, joints)
        found.append([float((pose @ [*end, 1.0])[2]) - capsule.radius for end in (capsule.a, capsule.b)])
    return np.array(found)


def test_low_points_are_those_of_the_limbs_shapes_that_stand_above_the_ground(hexapod: RobotModel) -> None:
    rng = np.random.default_rng(2)
    standing = ends(hexapod, np.array([0, 0, hexapod.nominal.body_height, 0, 0, 0]), hexapod.nominal.posture)
    for _ in range(6):
        base = np.array([0.1, 0.2, 0.1, *rng.uniform(-0.3, 0.3, 3)])
        joints = hexapod.nominal.posture.copy()
        for limb in hexapod.limbs:
            joints[hexapod.joint_indices(limb)] += rng.uniform(-0.6, 0.6, 3)
        found = low_points(hexapod, evaluate_limbs(hexapod, joints[None]), base[None], 0.05)
        heights = ends(hexapod, base, joints)
        expected = heights[(heights < 0.05) & (standing > 0.01)]
        assert len(expected) > 4
        assert sorted(p.height for p in found) == pytest.approx(sorted(expected.tolist()), abs=1e-9)


def test_feet_and_the_trunk_are_not_limbs_in_the_ground(hexapod: RobotModel) -> None:
    level = np.array([[0.0, 0.0, hexapod.nominal.body_height - 0.005, 0.0, 0.0, 0.0]])
    assert low_points(hexapod, evaluate_limbs(hexapod, hexapod.nominal.posture[None]), level, 0.0) == ()


def test_rows_are_the_heights_of_the_points(hexapod: RobotModel) -> None:
    low = LowPoint(1, 2, (0.01, -0.02, 0.03), 0.02, -0.01)
    problem, trajectory = gait_segment(hexapod, TRIPOD, Command(0.05)).build(MotionOptions(), [LimbHeight((low,))])
    term = next(t for t in problem.terms if t.family == "limb_height")
    rng, grid = np.random.default_rng(4), trajectory.grid
    x = rng.normal(0.0, 0.2, problem.size)
    values = term.kernel.value.map(len(term.variables))(x[term.variables].T, term.parameters.T).full().ravel()
    for k in range(grid.samples):
        base, joints = x[trajectory.base[k]], x[trajectory.joints[1][k]]
        pose = evaluate_limbs(hexapod, _spread(hexapod, 1, joints))[1]
        point = pose.origins[0, 2] + pose.turns[0, 2] @ low.point
        assert values[k] == pytest.approx(base[2] + float(matrices(base[3:6])[2] @ point), abs=1e-9)


def _spread(robot: RobotModel, limb: int, joints: np.ndarray) -> np.ndarray:
    q = np.zeros((1, len(robot.joint_names)))
    q[0, robot.joint_indices(robot.limbs[limb])] = joints
    return q


def test_a_leg_that_is_drawn_to_its_shin_walks_on_its_foot(
    monkeypatch: pytest.MonkeyPatch, hexapod: RobotModel
) -> None:
    flat = {"R2": [0.1, -1.3, -0.3]}
    plan = gf.plan_gait(hexapod, TRIPOD, posture=flat, body_height=0.06)
    assert plan.report.details["limb_height_m"] >= 0.0
    assert "limb_height" in plan.report.details["refined"][1]["for"]
    times = np.linspace(0.0, plan.duration, 97)
    base, joints = plan.base_spline(times), plan.joint_spline(times)
    link = hexapod.limb("R2").links[-1]
    assert min(cloud(hexapod, link, b, q) for b, q in zip(base[::8], joints[::8], strict=True)) > -1e-3
    monkeypatch.setattr(remedies, "low_free", lambda segment, report: [])
    lies = gf.plan_gait(hexapod, TRIPOD, posture=flat, body_height=0.06)
    assert lies.report.details["limb_height_m"] < -0.03
