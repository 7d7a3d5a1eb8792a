"""Efforts told ahead: with forces below the planned feet they are all that the planned motion needs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio
import pytest

import gaitforge as gf
from gaitforge.motion import feedforward
from gaitforge.motion.effort import joint_torques
from gaitforge.motion.feedforward import planned_efforts
from gaitforge.motion.foot_shares import foot_shares
from gaitforge.motion.manipulation.holding import Holding
from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.timeline import Timeline
from gaitforge.motion.timeline_build import build_timeline
from gaitforge.robot.model import RobotModel
from gaitforge.verify.execution import planned_rows

RATE = 500.0
LOAD = gf.Load(1.0, (0.05, 0.02, 0.1))


def contact_rows(robot: RobotModel, q: np.ndarray, feet: np.ndarray) -> np.ndarray:
    """(3 feet, nv) Jacobians of the lowest points of foot spheres, by Pinocchio's frames."""
    model, data = robot.pin, robot.pin.createData()
    pinocchio.computeJointJacobians(model, data, q)
    pinocchio.updateFramePlacements(model, data)
    rows = []
    for i in feet:
        foot = robot.limbs[i].foot
        frame = model.getFrameId(foot.link, pinocchio.FrameType.BODY)
        J = pinocchio.getFrameJacobian(model, data, frame, pinocchio.LOCAL_WORLD_ALIGNED)
        arm = data.oMf[frame].rotation @ np.array(foot.offset) - [0.0, 0.0, foot.radius]
        rows.append(J[:3] - pinocchio.skew(arm) @ J[3:])
    return np.vstack(rows)


def needed(robot: RobotModel, plan: MotionPlan, t: float, h: float = 1e-4) -> tuple[np.ndarray, np.ndarray]:
    """Configuration (nq,) and rnea (nv,) at t of a plan's own splines, their rates by differences on the manifold."""
    times = t + h * np.array([-1.0, 0.0, 1.0])
    q = robot.configuration(plan.base_spline(times), plan.joint_spline(times))
    before, after = (pinocchio.difference(robot.pin, one, other) / h for one, other in ((q[0], q[1]), (q[1], q[2])))
    data = robot.pin.createData()
    return q[1], pinocchio.rnea(robot.pin, data, q[1], 0.5 * (before + after), (after - before) / h)


def balanced(robot: RobotModel, plan: MotionPlan, t: float, efforts: np.ndarray) -> tuple[float, np.ndarray]:
    """What forces below the feet in stance leave of rnea minus efforts, and these forces (feet, 3) [N]."""
    q, rest = needed(robot, plan, t)
    rest[[robot.pin.joints[robot.pin.getJointId(n)].idx_v for n in robot.joint_names]] -= efforts
    column = int(t / plan.duration * plan.pattern.columns)
    rows = contact_rows(robot, q, np.flatnonzero(plan.pattern.contact[:, column]))
    forces, *_ = np.linalg.lstsq(rows.T, rest, rcond=None)
    return float(np.abs(rows.T @ forces - rest).max()), forces.reshape(-1, 3)


@pytest.mark.parametrize("load", [None, LOAD])
def test_with_forces_below_the_feet_in_stance_the_efforts_are_the_inverse_dynamics(
    gait: MotionPlan, robot_of, load: gf.Load | None
) -> None:
    bare = robot_of(gait)
    plan = replace(gait, loads=() if load is None else (load,))
    robot = bare.carrying(*plan.loads)
    timeline = build_timeline(bare, [(plan, 2)])
    rows = planned_rows(timeline, RATE)
    efforts = planned_efforts(bare, timeline, rows, RATE)
    for t in np.linspace(0.03, 0.97, 12) * plan.duration:
        t = round(t * RATE) / RATE
        left, forces = balanced(robot, plan, t, efforts[round(t * RATE)])
        assert left < 0.02  # [N, N m] of a weight of 60 or 130 N; second differences at 2 ms against 0.1 ms
        assert forces[:, 2].min() > 0.0
        assert forces[:, 2].sum() == pytest.approx(robot.mass * 9.81, rel=0.05)


def standing(plan: MotionPlan) -> MotionPlan:
    """The first moment of a gait, for all of its time; the weights are mended, since nothing accelerates any more."""
    first = plan.joint_positions[:, :1]
    still = np.tile(plan.base_poses[0], (len(plan.times), 1))
    weights, on = plan.weights[0, 1].copy(), plan.pattern.contact[:, 0]
    feet = np.vstack([np.ones(on.sum()), plan.feet[0, on, :2].T])
    weights[on] += np.linalg.pinv(feet) @ ([1.0, *plan.com[0, :2]] - feet @ weights[on])
    assert weights[on].min() > 0.0
    contact = np.tile(plan.pattern.contact[:, :1], plan.pattern.columns)
    return replace(
        plan,
        pattern=replace(plan.pattern, contact=contact),
        joint_positions=np.tile(first, len(plan.times)),
        base_poses=still,
        weights=np.tile(weights, (len(plan.times), 2, 1)),
    )


def test_feet_that_do_not_push_each_other_hold_the_plans_own_weights(
    monkeypatch: pytest.MonkeyPatch, hexapod: RobotModel, penta: MotionPlan
) -> None:
    monkeypatch.setattr(feedforward, "EVEN", 1e9)
    plan = standing(penta)
    timeline = build_timeline(hexapod, [(plan, 1)])
    found = planned_efforts(hexapod, timeline, planned_rows(timeline, 50.0), 50.0)[20]
    limbs = np.concatenate([hexapod.joint_indices(x) for x in hexapod.limbs])
    np.testing.assert_allclose(found[limbs], joint_torques(hexapod, plan)[0, 1, limbs], atol=1e-6)


def test_motors_are_spared_about_as_far_as_friction_lets_feet_push_each_other(
    hexapod: RobotModel, tripod: MotionPlan
) -> None:
    timeline = build_timeline(hexapod, [(tripod, 1)])
    efforts = planned_efforts(hexapod, timeline, planned_rows(timeline, RATE), RATE)
    alone = np.nanmax(np.abs(joint_torques(hexapod, tripod)) / hexapod.effort)
    assert np.abs(efforts / hexapod.effort).max() < 0.75 * alone
    for t in np.arange(0.1, 2.0, 0.2):
        _, forces = balanced(hexapod, tripod, t, efforts[round(t * RATE)])
        assert (np.linalg.norm(forces[:, :2], axis=1) < 0.6 * forces[:, 2]).all()


def least_squares(robot: RobotModel, plan: MotionPlan, t: float) -> float:
    """Σ (τ / limit)² of the forces that spare the motors most, by the null space of the balance of the base."""
    q, rest = needed(robot, plan, t)
    column = int(t / plan.duration * plan.pattern.columns)
    rows = contact_rows(robot, q, np.flatnonzero(plan.pattern.contact[:, column]))
    order = [robot.pin.joints[robot.pin.getJointId(n)].idx_v for n in robot.joint_names]
    some, *_ = np.linalg.lstsq(rows[:, :6].T, rest[:6], rcond=None)
    free = np.linalg.svd(rows[:, :6].T)[2][6:].T
    away, turn = (rest[order] - rows[:, order].T @ some) / robot.effort, (rows[:, order].T @ free).T / robot.effort
    z, *_ = np.linalg.lstsq(turn.T, away, rcond=None)
    return float(((away - turn.T @ z) ** 2).sum())


def test_where_evenness_costs_nothing_no_other_forces_ask_for_less(
    monkeypatch: pytest.MonkeyPatch, hexapod: RobotModel, tripod: MotionPlan
) -> None:
    timeline = build_timeline(hexapod, [(tripod, 1)])
    rows = planned_rows(timeline, RATE)
    monkeypatch.setattr(feedforward, "EVEN", 1e-6)
    efforts = planned_efforts(hexapod, timeline, rows, RATE)
    for t in (0.3, 0.7, 1.2, 1.6):
        found = float(((efforts[round(t * RATE)] / hexapod.effort) ** 2).sum())
        assert found == pytest.approx(least_squares(hexapod, tripod, t), rel=1e-3)


def test_load_comes_and_goes_while_a_foot_stands_unless_others_have_to_take_it_at_once(
    hexapod: RobotModel, start: MotionPlan, tripod: MotionPlan, change: MotionPlan, penta: MotionPlan, stop: MotionPlan
) -> None:
    timeline = build_timeline(hexapod, [(start, 1), (tripod, 2), (change, 1), (penta, 2), (stop, 1)])
    rows = planned_rows(timeline, RATE)
    shares = foot_shares(timeline, rows)
    np.testing.assert_allclose(shares.sum(axis=1), 1.0, atol=1e-9)
    assert not shares[~rows.contact].any()
    assert (shares.max(axis=1) <= 1.0).all()
    steps = np.flatnonzero((np.diff(rows.contact.astype(int), axis=0) != 0).any(axis=1))
    jumps = np.abs(np.diff(shares, axis=0)).max(axis=1)
    exchange = [(now & ~then).any() and (then & ~now).any() for then, now in zip(
        rows.contact[steps], rows.contact[steps + 1], strict=True)]  # fmt: skip
    assert any(exchange)
    assert not all(exchange)
    smooth = np.setdiff1d(np.arange(len(jumps)), steps[exchange])
    assert jumps[smooth].max() < 0.06  # a foot takes its load in a twelfth of a second at least
    assert jumps[steps[exchange]].min() > 0.1


def test_a_plan_without_weights_shares_evenly(hexapod: RobotModel, tripod: MotionPlan) -> None:
    bare = replace(tripod, weights=np.zeros_like(tripod.weights))
    timeline = build_timeline(hexapod, [(bare, 1)])
    rows = planned_rows(timeline, 50.0)
    np.testing.assert_allclose(foot_shares(timeline, rows), rows.contact / 3.0, atol=1e-9)


def lifting(robot: RobotModel, plan: MotionPlan, mass: float) -> Timeline:
    """Standing, while tips lift an object 0.2 m above the trunk by 5 cm."""
    plan = standing(plan)
    poses = np.tile([0.0, 0.0, 0.2, 0.0, 0.0, 0.0], (len(plan.times), 1))
    poses[:, 2] += np.linspace(0.0, 0.05, len(plan.times))
    return build_timeline(robot, [(replace(plan, holdings=(Holding("box", poses, (), {}, mass),)), 1)])


def test_what_tips_have_lifted_weighs_on_the_feet(hexapod: RobotModel, penta: MotionPlan) -> None:
    carried = [0.0, 1.0]
    weights = []
    for mass in carried:
        timeline = lifting(hexapod, penta, mass)
        rows = planned_rows(timeline, 50.0)
        efforts = planned_efforts(hexapod, timeline, rows, 50.0)
        plan = timeline.entries[0].plan
        weights.append([vertical(hexapod, plan, rows.joint_positions[k], efforts[k]) for k in (0, 50)])
    assert weights[1][0] == pytest.approx(weights[0][0], abs=0.01)  # it stands where it was
    assert weights[1][1] == pytest.approx(weights[0][1] + 9.81, abs=0.01)


def vertical(robot: RobotModel, plan: MotionPlan, joints: np.ndarray, efforts: np.ndarray) -> float:
    """[N] that stance feet push down with, by the joints' rows alone."""
    q = robot.configuration(plan.base_poses[0], joints)
    order = [robot.pin.joints[robot.pin.getJointId(n)].idx_v for n in robot.joint_names]
    gravity = pinocchio.computeGeneralizedGravity(robot.pin, robot.pin.createData(), q)
    rows = contact_rows(robot, q, np.flatnonzero(plan.pattern.contact[:, 0]))[:, order]
    forces, *_ = np.linalg.lstsq(rows.T, gravity[order] - efforts, rcond=None)
    return float(forces.reshape(-1, 3)[:, 2].sum())


def test_rates_of_a_parabola_are_exact_to_its_ends() -> None:
    t = np.arange(50) / RATE
    rate = feedforward._rate((1.5 * t**2 - t)[:, None], RATE)[:, 0]
    np.testing.assert_allclose(rate, 3.0 * t - 1.0, atol=1e-9)
    np.testing.assert_allclose(feedforward._rate(rate[:, None], RATE)[:, 0], 3.0, atol=1e-6)
    assert feedforward._rate(np.ones((1, 3)), RATE).tolist() == [[0.0] * 3]


def test_efforts_come_and_go_with_the_load_of_a_foot(hexapod: RobotModel, penta: MotionPlan) -> None:
    timeline = build_timeline(hexapod, [(penta, 1)])
    rows = planned_rows(timeline, RATE)
    efforts = planned_efforts(hexapod, timeline, rows, RATE)
    lifts_and_lands = np.diff(rows.contact.astype(int), axis=0)
    alike = (lifts_and_lands >= 0).all(axis=1) | (lifts_and_lands <= 0).all(axis=1)
    moved = lifts_and_lands.any(axis=1) & alike
    assert moved.sum() >= 4
    assert np.abs(np.diff(efforts, axis=0))[moved].max() < 0.4
