"""No plan: a certificate where there is a proof, and otherwise who resists, where and by how much."""

from __future__ import annotations

import numpy as np
import pytest

import gaitforge as gf
from gaitforge.errors import InfeasibleMotion, UnsolvedError
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion.limits import fastest_foot, longest_reach, refuse_impossible_speed
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import Command
from gaitforge.motion.refine import solve_refined
from gaitforge.motion.solvers.ipopt import Ipopt
from gaitforge.motion.trajectory import Discretisation
from gaitforge.robot.model import RobotModel
from tests.motion.motion_kit import TRIPOD, gait_segment

QUICK = MotionOptions(samples_per_column=1, finest=1, stability_shares=(0.3,), solver=Ipopt(max_iterations=25))


def test_a_speed_that_no_joint_can_follow_is_infeasible_with_limb_and_advice(hexapod: RobotModel) -> None:
    with pytest.raises(InfeasibleMotion, match=r"2 m/s is impossible: limb L1") as refusal:
        gf.plan_gait(hexapod, TRIPOD, speed=2.0)
    explain = refusal.value.explain
    assert explain["limbs"] == ["L1"]
    assert explain["families"] in (["joint_speed"], ["reach"])
    assert "walk slower than" in explain["advice"]


def test_the_advised_speed_is_not_refused_and_a_little_more_is(hexapod: RobotModel) -> None:
    with pytest.raises(InfeasibleMotion) as refusal:
        refuse_impossible_speed(hexapod, Discretisation(TRIPOD, 1, 2.0, Command(2.0)))
    limit = float(refusal.value.explain["advice"].split("than ")[1].split(" m/s")[0])
    refuse_impossible_speed(hexapod, Discretisation(TRIPOD, 1, 2.0, Command(limit - 0.01)))
    with pytest.raises(InfeasibleMotion):
        refuse_impossible_speed(hexapod, Discretisation(TRIPOD, 1, 2.0, Command(limit + 0.01)))


def test_a_short_swing_is_refused_for_its_joint_speed(hexapod: RobotModel) -> None:
    contact = np.ones((6, 60), dtype=bool)
    for i in range(6):
        contact[i, 10 * i] = False
    pattern = FootfallPattern(contact, hexapod.limb_names)
    with pytest.raises(InfeasibleMotion, match="its joints allow at most"):
        gf.plan_gait(hexapod, pattern, speed=0.064, duration=2.0)


def test_the_bounds_of_the_certificate_hold_for_random_motions(any_robot: RobotModel) -> None:
    """No foot is ever faster against the base, or two places of it farther apart, than the certificate says."""
    rng, h = np.random.default_rng(3), 1e-6
    base = np.zeros(6)
    joints = rng.uniform(any_robot.lower, any_robot.upper, (60, len(any_robot.joint_names)))
    rates = rng.choice([-1.0, 1.0], joints.shape) * any_robot.velocity
    feet = np.array([any_robot.foot_positions(base, q) for q in joints])
    moved = np.array([any_robot.foot_positions(base, q + h * v) for q, v in zip(joints, rates, strict=True)])
    for i, limb in enumerate(any_robot.limbs):
        speed = np.linalg.norm(moved[:, i] - feet[:, i], axis=1).max() / h
        assert speed < fastest_foot(any_robot, limb) * (1 + 1e-6)
        assert speed > 0.2 * fastest_foot(any_robot, limb), "a bound, not a platitude"
        apart = np.linalg.norm(feet[:, None, i] - feet[None, :, i], axis=2).max()
        assert 0.2 * longest_reach(any_robot, limb) < apart < longest_reach(any_robot, limb)


def test_a_robot_that_would_tip_over_is_unsolved_and_the_error_says_who_resists(hexapod: RobotModel) -> None:
    rows = {name: "000111111111" if name[0] == "L" else "111111111111" for name in hexapod.limb_names}
    with pytest.raises(UnsolvedError) as refusal:
        gf.plan_gait(hexapod, FootfallPattern.from_rows(rows), options=QUICK, name="lean")
    explain, message = refusal.value.explain, str(refusal.value)
    assert explain["segment"] == "lean"
    assert "balance" in explain["families"]
    assert any(name in explain["where"] for name in hexapod.limb_names)
    assert explain["value"] > 1e-5
    assert all(word in message for word in ("lean", explain["text"]))
    tipping = [c for c in explain["causes"] if c["family"] == "balance"]
    assert tipping
    assert tipping[0]["by"] > 1e-3
    assert set(tipping[0]["limb"].split("+")) <= {"R1", "R2", "R3"}
    assert refusal.value.exit_code == 5
    assert explain["advice"]


def test_a_step_that_a_limb_cannot_make_is_unsolved_naming_limb_and_sample(hexapod: RobotModel) -> None:
    with pytest.raises(UnsolvedError) as refusal:
        gf.plan_gait(hexapod, TRIPOD, step_height=0.6, options=QUICK)
    explain = refusal.value.explain
    assert set(explain["families"]) & {"kinematics", "joint_speed"}
    limb, sample = explain["where"].strip("()").split(", ")
    assert limb.strip("'") in hexapod.limb_names
    k = int(sample)
    assert not TRIPOD.contact[hexapod.limb_names.index(limb.strip("'")), k], "in the middle of its swing"
    assert explain["unit"] == "m"


def test_the_next_stability_share_is_taken_and_said_when_there_is_no_plan(hexapod: RobotModel) -> None:
    """A gait whose weights cannot all be equal: share 1 has no plan, 0.3 has."""
    segment = gait_segment(hexapod, TRIPOD, Command(0.05))
    options = MotionOptions(
        samples_per_column=1, finest=1, stability_shares=(1.0, 0.3), solver=Ipopt(max_iterations=40)
    )
    plan = solve_refined(segment, options)
    assert "stability share 0.3" in plan.relaxed
    assert plan.report.details["stability_share"] == 0.3


def test_a_plan_that_misses_a_bound_after_all_refinements_is_not_returned(hexapod: RobotModel) -> None:
    options = MotionOptions(samples_per_column=1, speed_share=0.2, refinements=0, stability_shares=(0.3,))
    with pytest.raises(UnsolvedError, match="after 0 refinements the spline still misses a bound") as refusal:
        gf.plan_gait(hexapod, TRIPOD, options=options)
    explain = refusal.value.explain
    assert explain["families"] == ["ground", "joint_speed"]
    assert explain["speed_ratio"] > 0.2
    assert explain["penetration_m"] > options.ground_tolerance
    assert f"{explain['penetration_m'] * 1e3:.1f} mm in the ground" in str(refusal.value)
    assert f"at {explain['speed_ratio']:.2f} of its speed limit" in str(refusal.value)
