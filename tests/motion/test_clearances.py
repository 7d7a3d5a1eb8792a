"""Limbs keep clear of each other: distances against brute force, and plans that would touch."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize

import gaitforge as gf
from gaitforge.motion.bodies import BASE, closest_pairs, ends_in_base, limb_capsules, segment_distance
from gaitforge.motion.plan import MotionPlan
from gaitforge.robot.kinematics import evaluate_limb, limb_parameters
from gaitforge.robot.model import RobotModel
from tests.motion.motion_kit import PATIENT, TRIPOD

FAST = 0.13
"""[m/s] with steps so long that neighbouring limbs come near"""

coordinate = st.floats(-1.0, 1.0).map(lambda v: round(v, 3))
point = st.tuples(coordinate, coordinate, coordinate).map(np.array)


def nearest(a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray) -> float:
    """Distance of two segments by bounded minimisation from a grid (the squared distance is convex)."""
    s, t = np.meshgrid(np.linspace(0, 1, 21), np.linspace(0, 1, 21))
    gaps = (a + s[..., None] * (b - a)) - (c + t[..., None] * (d - c))
    at = np.unravel_index(np.linalg.norm(gaps, axis=2).argmin(), s.shape)

    def squared(v: np.ndarray) -> tuple[float, np.ndarray]:
        gap = a + v[0] * (b - a) - c - v[1] * (d - c)
        return float(gap @ gap), 2 * np.array([gap @ (b - a), -gap @ (d - c)])

    best = minimize(
        squared, [s[at], t[at]], jac=True, bounds=[(0, 1), (0, 1)], tol=1e-16, options={"ftol": 1e-18, "gtol": 1e-12}
    )
    return float(np.sqrt(best.fun))


@settings(max_examples=200, deadline=None, derandomize=True)
@given(point, point, point, point)
def test_the_distance_of_segments_is_what_minimisation_finds(
    a: np.ndarray, b: np.ndarray, c: np.ndarray, d: np.ndarray
) -> None:
    """Crossing, parallel, of no length: whatever comes."""
    s, t, distance = (v[0] for v in segment_distance(a[None], b[None], c[None], d[None]))
    assert 0 <= s <= 1
    assert 0 <= t <= 1
    assert np.linalg.norm(a + s * (b - a) - c - t * (d - c)) == pytest.approx(distance, abs=1e-12)
    least = nearest(a, b, c, d)  # minimisation may stop a little early, never too low
    assert least - 2e-5 < distance < least + 2e-6


@pytest.mark.parametrize(
    ("ends", "expected"),
    [
        (([0, 0, 0], [1, 0, 0], [0.2, 0.5, 0], [0.8, 0.5, 0]), 0.5),  # parallel, side by side
        (([0, 0, 0], [1, 0, 0], [3, 0, 0], [2, 0, 0]), 1.0),  # on one line
        (([0, 0, 0], [1, 0, 0], [2, 1, 0], [3, 1, 0]), np.sqrt(2)),  # parallel, past each other
        (([0, 0, 0], [0, 0, 0], [1, 2, 2], [1, 2, 2]), 3.0),  # two points
        (([0, 0, 0], [0, 0, 0], [-1, 1, 0], [1, 1, 0]), 1.0),  # a point and a segment
        (([-1, 0, 0], [1, 0, 0], [0, -1, 0.3], [0, 1, 0.3]), 0.3),  # crossing
    ],
)
def test_distances_that_can_be_seen_by_eye(ends: tuple[list[float], ...], expected: float) -> None:
    _, _, distance = segment_distance(*(np.array([e], dtype=float) for e in ends))
    assert distance[0] == pytest.approx(expected, abs=1e-7)


def capsule_ends(robot: RobotModel, joints: np.ndarray) -> list[tuple[str, int, np.ndarray, np.ndarray, float]]:
    """(link, limb, a, b, radius) of every capsule in the base frame, by Pinocchio's link poses."""
    owner = {link: i for i, limb in enumerate(robot.limbs) for link in limb.links}
    out = []
    for capsule in robot.capsules:
        pose = robot.link_pose(capsule.link, np.zeros(6), joints)
        a, b = (pose[:3, :3] @ np.array(v) + pose[:3, 3] for v in (capsule.a, capsule.b))
        out.append((capsule.link, owner.get(capsule.link, BASE), a, b, capsule.radius))
    return out


def test_capsules_are_where_the_links_are(any_robot: RobotModel) -> None:
    rng = np.random.default_rng(7)
    joints = any_robot.nominal.posture + rng.uniform(-0.4, 0.4, len(any_robot.joint_names))
    for limb in any_robot.limbs:
        for name in limb.tool_joints:  # taken at their nominal position
            joints[any_robot.joint_names.index(name)] = any_robot.nominal.posture[any_robot.joint_names.index(name)]
    poses = {
        i: evaluate_limb(joints[None, any_robot.joint_indices(limb)], limb_parameters(any_robot, limb))
        for i, limb in enumerate(any_robot.limbs)
    }
    found, expected = limb_capsules(any_robot), capsule_ends(any_robot, joints)
    assert len(found) == len(expected) > 0
    for ours, (link, limb, a, b, radius) in zip(found, expected, strict=True):
        ends = ends_in_base(ours, poses, 1)
        assert (ours.name, ours.limb, ours.radius) == (link, limb, radius)
        assert ends[0][0] == pytest.approx(a, abs=1e-9)
        assert ends[1][0] == pytest.approx(b, abs=1e-9)


def smallest_gap(robot: RobotModel, plan: MotionPlan, times: np.ndarray) -> float:
    """[m] between bodies of different limbs along the spline: Pinocchio's link poses, distances by sampled axes."""
    share = np.linspace(0.0, 1.0, 25)[:, None]
    worst = np.inf
    for t in times:
        ends = capsule_ends(robot, plan(t))
        middles = [0.5 * (a + b) for _, _, a, b, _ in ends]
        for i, j in combinations(range(len(ends)), 2):
            (_, one, a, b, r), (_, other, c, d, q) = ends[i], ends[j]
            reach = 0.5 * (np.linalg.norm(b - a) + np.linalg.norm(d - c)) + r + q + 0.05
            if one == other or BASE in (one, other) or np.linalg.norm(middles[i] - middles[j]) > reach:
                continue
            gaps = np.linalg.norm((a + share * (b - a))[:, None] - (c + share * (d - c))[None], axis=2)
            worst = min(worst, float(gaps.min()) - r - q)
    return worst


def test_a_gait_that_comes_nearer_than_asked_is_planned_again_and_keeps_its_distance(hexapod: RobotModel) -> None:
    """What is asked for is kept, between samples too, measured without the project's kinematics."""
    free = gf.plan_gait(hexapod, TRIPOD, speed=FAST, samples_per_column=2, options=replace(PATIENT, clearance=-1.0))
    assert free.report.details["refinements"] == 0
    times = np.linspace(0.0, free.duration, 97)
    without = smallest_gap(hexapod, free, times)
    asked = 2 * without + 0.004
    kept = gf.plan_gait(hexapod, TRIPOD, speed=FAST, samples_per_column=2, options=replace(PATIENT, clearance=asked))
    assert kept.report.details["refinements"] >= 1
    assert smallest_gap(hexapod, kept, kept.times) > asked - 5e-4
    assert smallest_gap(hexapod, kept, times) > asked - 1.5e-3


def test_close_pairs_are_all_pairs_of_different_limbs_within_the_margin(hexapod: RobotModel) -> None:
    joints = hexapod.nominal.posture + np.random.default_rng(9).uniform(-0.5, 0.5, len(hexapod.joint_names))
    joints[[hexapod.joint_names.index(n) for limb in hexapod.limbs for n in limb.tool_joints]] = 0.0
    poses = {
        i: evaluate_limb(joints[None, hexapod.joint_indices(limb)], limb_parameters(hexapod, limb))
        for i, limb in enumerate(hexapod.limbs)
    }
    margin = 0.12
    found = {
        (c.first.name, c.second.name, tuple(c.first.a), tuple(c.second.a)): c.gap
        for c in closest_pairs(limb_capsules(hexapod), poses, margin)
    }
    ends, ours = capsule_ends(hexapod, joints), limb_capsules(hexapod)
    expected = {}
    for i, j in combinations(range(len(ends)), 2):
        (_, one, a, b, r), (_, other, c, d, q) = ends[i], ends[j]
        if one != other and (gap := nearest(a, b, c, d) - r - q) < margin:
            expected[(ours[i].name, ours[j].name, tuple(ours[i].a), tuple(ours[j].a))] = gap
    assert len(expected) >= 3
    assert found.keys() == expected.keys()
    for key, gap in expected.items():
        assert found[key] == pytest.approx(gap, abs=1e-6)


def test_clearances_that_a_finer_grid_inherits_spare_it_the_search_for_them(hexapod: RobotModel) -> None:
    """Five limbs in 3 s: long steps, for which both a finer grid and clearances are needed."""
    pattern = gf.synthesize_gait_pattern(hexapod, locomotive=["L2", "L3", "R1", "R2", "R3"])
    plan = gf.plan_gait(hexapod, pattern, speed=0.1, duration=3.0, options=PATIENT)
    log = plan.report.details["refined"]
    grown = next(i for i, entry in enumerate(log) if i and entry["variables"] > log[i - 1]["variables"])
    assert "clearance" in log[grown]["for"]
    assert plan.relaxed == ()
    assert plan.report.details["refinements"] <= 4
