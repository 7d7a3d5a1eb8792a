"""Limbs and the trunk: distances against a cloud of points, and what is left out."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

import gaitforge as gf
from gaitforge.errors import InfeasibleMotion
from gaitforge.motion.bodies import BASE, limb_capsules
from gaitforge.motion.constraints.trunk_height import TrunkHeight
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import Command
from gaitforge.motion.trunk import (
    closest_to_trunk,
    gaps,
    nearest_on,
    signed_distance,
    trunk_corners,
    trunk_height,
)
from gaitforge.robot.kinematics import evaluate_limbs
from gaitforge.robot.model import Box, RobotModel
from gaitforge.robot.rotation import matrices
from tests.motion.motion_kit import TRIPOD, gait_segment

TURN = matrices([0.3, -0.5, 0.9])
BOX = Box((0.1, -0.2, 0.05), tuple(tuple(float(v) for v in row) for row in TURN), (0.3, 0.2, 0.1))


def surface(box: Box, count: int = 41) -> np.ndarray:
    """(n, 3) points all over the surface of a box."""
    line = np.linspace(-0.5, 0.5, count)
    grid = np.array([p for p in product(line, repeat=3) if max(abs(v) for v in p) == 0.5])
    return (grid * box.size) @ np.array(box.rotation).T + np.array(box.center)


def test_the_distance_from_a_box_is_that_of_the_nearest_point_of_its_surface() -> None:
    cloud, points = surface(BOX), np.random.default_rng(0).uniform(-0.4, 0.4, (200, 3))
    found = signed_distance(BOX, points)
    brute = np.linalg.norm(points[:, None] - cloud, axis=2).min(axis=1)
    assert (found < 0).any()
    assert np.abs(found) == pytest.approx(brute, abs=4e-3)
    for point, distance in zip(points, found, strict=True):
        touched = nearest_on(BOX, point)
        assert signed_distance(BOX, touched[None])[0] == pytest.approx(0.0, abs=1e-12)
        assert np.linalg.norm(touched - point) == pytest.approx(abs(distance), abs=1e-12)


def test_the_gap_of_a_capsule_is_the_smallest_along_its_axis() -> None:
    rng = np.random.default_rng(1)
    a, b = rng.uniform(-0.5, 0.5, (2, 60, 4, 3))
    radius = rng.uniform(0.005, 0.03, 60)
    found, share = gaps(BOX, a, b, radius, margin=0.1)
    s = np.linspace(0.0, 1.0, 2001)[:, None, None, None]
    brute = signed_distance(BOX, a + s * (b - a)).min(axis=0) - radius[:, None]
    near = np.isfinite(found)
    assert found[near] == pytest.approx(brute[near], abs=1e-3)
    assert (brute[~near] > 0.1).all()
    assert near.any()
    assert ((share >= 0) & (share <= 1)).all()


def test_a_limb_folded_into_the_trunk_is_found_and_the_standing_robot_is_not(any_robot: RobotModel) -> None:
    standing = any_robot.nominal.posture
    assert closest_to_trunk(any_robot, evaluate_limbs(any_robot, standing[None]), 0.02) == []
    rng, found = np.random.default_rng(2), []
    rows = any_robot.joint_indices(any_robot.limbs[0])
    for _ in range(300):
        joints = standing.copy()
        joints[rows] = rng.uniform(any_robot.lower[rows], any_robot.upper[rows]).clip(-2.5, 2.5)
        found += closest_to_trunk(any_robot, evaluate_limbs(any_robot, joints[None]), 0.02)
    assert found
    assert {c.first.limb for c in found} == {0}
    assert {c.second.limb for c in found} == {BASE}
    assert min(c.gap for c in found) < 0.0


def test_what_comes_near_between_samples_is_told_at_the_nearest_sample_with_what_was_lost(hexapod: RobotModel) -> None:
    """One limb folds into the trunk a quarter of an interval after sample 1 and is back at sample 2."""
    joints = np.tile(hexapod.nominal.posture, (13, 1))
    folded = next(
        q for q in _postures(hexapod) if any(c.gap < 0.0 for c in closest_to_trunk(hexapod, _poses(hexapod, q), 0.02))
    )
    joints[5] = folded
    found = closest_to_trunk(hexapod, evaluate_limbs(hexapod, joints), 0.02, per_interval=4)
    assert {c.sample for c in found} == {1}
    for pair in found:
        assert pair.dip == pytest.approx(0.02 - pair.gap, abs=1e-9)


def _postures(robot: RobotModel):
    rng, rows = np.random.default_rng(2), robot.joint_indices(robot.limbs[0])
    while True:
        joints = robot.nominal.posture.copy()
        joints[rows] = rng.uniform(robot.lower[rows], robot.upper[rows])
        yield joints


def _poses(robot: RobotModel, joints: np.ndarray):
    return evaluate_limbs(robot, joints[None])


def test_the_trunk_is_made_of_the_shapes_of_the_base(hexapod: RobotModel) -> None:
    plate = max(hexapod.trunk, key=lambda box: float(np.prod(box.size)))
    assert sorted(plate.size) == pytest.approx([0.0762, 0.185, 0.3])
    assert len(limb_capsules(hexapod)) == len(hexapod.capsules)


def test_the_height_of_the_trunk_is_that_of_its_lowest_point(hexapod: RobotModel) -> None:
    poses = np.random.default_rng(3).uniform(-0.4, 0.4, (20, 6))
    clouds = np.concatenate([surface(box, 9) for box in hexapod.trunk])
    turned = poses[:, None, :3] + np.einsum("nij,pj->npi", matrices(poses[:, 3:6]), clouds)
    assert trunk_height(hexapod, poses) == pytest.approx(float(turned[..., 2].min()), abs=1e-9)


def test_the_rows_of_the_trunk_are_heights_of_its_corners_with_exact_derivatives(hexapod: RobotModel) -> None:
    corners = tuple((float(x), float(y), float(z)) for x, y, z in trunk_corners(hexapod))
    problem, trajectory = gait_segment(hexapod, TRIPOD, Command(0.05)).build(MotionOptions(), [TrunkHeight(corners)])
    term = next(t for t in problem.terms if t.family == "trunk_height")
    assert len(term.variables) == trajectory.grid.samples
    base = np.random.default_rng(4).uniform(-0.5, 0.5, 6)
    heights, jacobian = (np.array(v).ravel() for v in term.kernel.first(base, term.parameters[0]))
    expected = base[2] + (matrices(base[3:6]) @ trunk_corners(hexapod).T)[2]
    assert heights == pytest.approx(expected, abs=1e-12)
    dense, h = np.zeros((4, 6)), 1e-6
    dense[term.kernel.jacobian_rc] = jacobian
    for k, step in enumerate(h * np.eye(6)):
        up, down = (np.array(term.kernel.value(base + s * step, term.parameters[0])).ravel() for s in (1, -1))
        assert dense[:, k] == pytest.approx((up - down) / (2 * h), abs=1e-8)


def test_a_body_commanded_into_the_ground_is_lifted_out_of_it_or_refused(hexapod: RobotModel) -> None:
    low = gf.plan_gait(hexapod, TRIPOD, body_height=0.0)
    assert ["trunk_height"] in [entry["for"] for entry in low.report.details["refined"]]
    assert low.report.details["trunk_height_m"] >= 0.0
    with pytest.raises(InfeasibleMotion, match="in the ground") as refusal:
        gf.plan_gait(hexapod, TRIPOD, body_height=-0.08)
    limit = float(refusal.value.explain["advice"].split("above ")[1].split(" m")[0])
    gf.plan_gait(hexapod, TRIPOD, body_height=limit + 0.01)
