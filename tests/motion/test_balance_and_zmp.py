"""Centre of pressure: of the plan's weights, of the inverted pendulum, and by inverse dynamics."""

from __future__ import annotations

import numpy as np
import pinocchio
import pytest
from shapely import Point, affinity
from shapely.geometry import MultiPoint

from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion.plan import Command, MotionPlan, carry
from gaitforge.motion.zmp import zero_moment_point
from gaitforge.robot.model import RobotModel
from tests.motion.motion_kit import held

GRAVITY = 9.81


def com_acceleration(robot: RobotModel, plan: MotionPlan) -> np.ndarray:
    """(N + 1, 3) by differences of Pinocchio's centre of mass at the samples; clamped or periodic at the ends."""
    h = plan.times[1]
    com = np.array([robot.center_of_mass(b, q) for b, q in zip(plan.base_poses, plan.joint_positions.T, strict=True)])
    if plan.kind == "gait":
        ends = plan.base_poses[0], plan.base_poses[-1]
        before = carry(np.append(com[-2], np.zeros(3))[None], *ends, -1)[0, :3]
        after = carry(np.append(com[1], np.zeros(3))[None], *ends, 1)[0, :3]
        com = np.vstack([before, com, after])
        return np.diff(com, 2, axis=0) / h**2
    speeds = []
    for t, base, joints in zip((0.0, plan.duration), plan.base_velocity_ends, plan.joint_velocity_ends, strict=True):
        pose, q = plan.base_spline(t), plan(t)
        data = robot.pin.createData()
        pinocchio.centerOfMass(robot.pin, data, robot.configuration(pose, q), robot.velocity_vector(pose, base, joints))
        speeds.append(np.array(data.vcom[0]))
    first = 2 * ((com[1] - com[0]) / h - speeds[0]) / h
    last = 2 * (speeds[1] - (com[-1] - com[-2]) / h) / h
    return np.vstack([first, np.diff(com, 2, axis=0) / h**2, last])


def feet_of(plan: MotionPlan, k: int, side: int) -> np.ndarray | None:
    """Limbs in stance in the interval before (0) or after (1) sample k; None beyond an open end."""
    interval, count = k - 1 + side, len(plan.times) - 1
    if plan.kind == "gait":
        interval %= count
    if not 0 <= interval < count:
        return None
    return np.flatnonzero(plan.pattern.contact[:, interval // plan.samples_per_column])


def test_the_weights_reproduce_the_centre_of_pressure(plan: MotionPlan, robot_of) -> None:
    robot = robot_of(plan)
    acceleration = com_acceleration(robot, plan)
    checked = 0
    for k in range(len(plan.times)):
        x, a = robot.center_of_mass(plan.base_poses[k], plan.joint_positions[:, k]), acceleration[k]
        pressure = x[:2] - x[2] / (GRAVITY + a[2]) * a[:2]
        feet = robot.foot_positions(plan.base_poses[k], plan.joint_positions[:, k])
        for side in (0, 1):
            stance, w = feet_of(plan, k, side), plan.weights[k, side]
            if stance is None:
                assert not w.any()
                continue
            assert set(np.flatnonzero(w)) == set(stance)
            assert w.sum() == pytest.approx(1.0, abs=1e-9)
            assert w @ feet[:, :2] == pytest.approx(pressure, abs=2e-5)
            checked += 1
    assert checked >= 2 * (len(plan.times) - 1)


def test_every_foot_carries_its_share_and_the_pressure_stays_in_the_shrunk_polygon(plan: MotionPlan, robot_of) -> None:
    robot, share = robot_of(plan), plan.report.details["stability_share"]
    acceleration = com_acceleration(robot, plan)
    for k in range(len(plan.times)):
        lift = 1 + acceleration[k, 2] / GRAVITY  # the force of all feet in body weights
        feet = robot.foot_positions(plan.base_poses[k], plan.joint_positions[:, k])[:, :2]
        for side in (0, 1):
            stance = feet_of(plan, k, side)
            if stance is None:
                continue
            w = plan.weights[k, side, stance]
            assert w.min() * lift > share / len(stance) - 1e-6
            left, centre = 1 - share / lift, Point(feet[stance].mean(axis=0))
            shrunk = affinity.scale(MultiPoint(feet[stance]).convex_hull, left, left, origin=centre)
            assert shrunk.buffer(1e-5).contains(Point(w @ feet[stance]))


def test_the_pendulum_and_inverse_dynamics_agree_for_the_tripod(tripod: MotionPlan, hexapod: RobotModel) -> None:
    points = zero_moment_point(hexapod, tripod)
    z = np.array([hexapod.center_of_mass(tripod.base_spline(t), tripod(t)) for t in points.times])
    assert points.com == pytest.approx(z, abs=1e-12)
    h = 1e-3
    before, after = (
        np.array([hexapod.center_of_mass(tripod.base_spline(t + s), tripod(t + s)) for t in points.times])
        for s in (-h, h)
    )
    acceleration = (before - 2 * z + after) / h**2
    pendulum = z[:, :2] - (z[:, 2] / (GRAVITY + acceleration[:, 2]))[:, None] * acceleration[:, :2]
    apart = np.linalg.norm(points.zmp - pendulum, axis=1)
    assert apart.max() < 0.015
    assert np.median(apart) < 0.007
    assert points.margin.min() > 0.020


def test_the_zmp_stays_inside_the_feet_for_every_gait(gait: MotionPlan, robot_of) -> None:
    assert zero_moment_point(robot_of(gait), gait).margin.min() > 0.0


def test_the_zmp_is_where_the_change_of_momentum_says(turning: MotionPlan, hexapod: RobotModel) -> None:
    """ṗ and L̇ about the centre of mass by differences of Pinocchio's centroidal momentum along the splines."""

    def momentum(t: float) -> np.ndarray:
        base, data = turning.base_spline(t), hexapod.pin.createData()
        q = hexapod.configuration(base, turning.joint_spline(t))
        v = hexapod.velocity_vector(base, turning.base_spline(t, 1), turning.joint_spline(t, 1))
        return np.array(pinocchio.computeCentroidalMomentum(hexapod.pin, data, q, v).vector)

    points, h = zero_moment_point(hexapod, turning, per_interval=1), 1e-4
    for k in range(0, len(points.times), 3):
        t, c = points.times[k], points.com[k]
        change = (momentum(t + h) - momentum(t - h)) / (2 * h)
        force = change[:3] + np.array([0.0, 0.0, hexapod.mass * GRAVITY])
        # ground force at (p, 0): L̇ = (p − c) × F, its horizontal part
        px = c[0] - (c[2] * force[0] + change[4]) / force[2]
        py = c[1] + (change[3] - c[2] * force[1]) / force[2]
        assert points.zmp[k] == pytest.approx([px, py], abs=1e-6)


def bent(robot: RobotModel) -> np.ndarray:
    """(n_J,) a posture without any symmetry."""
    return robot.nominal.posture + np.linspace(-0.3, 0.3, len(robot.joint_names))


def locked(robot: RobotModel, base: np.ndarray, times: np.ndarray, speeds: np.ndarray) -> MotionPlan:
    """All joints still in a bent posture, the base on given poses."""
    joints = bent(robot)
    columns = np.ones((len(robot.limbs), len(times) - 1), dtype=bool)
    return MotionPlan(
        name="locked", kind="stand", pattern=FootfallPattern(columns, robot.limb_names, cyclic=False), times=times,
        joint_positions=np.tile(joints[:, None], len(times)), base_poses=base, com=np.zeros((len(times), 3)),
        feet=np.zeros((len(times), len(robot.limbs), 3)), weights=np.zeros((len(times), 2, len(robot.limbs))),
        command=Command(), joint_velocity_ends=np.zeros((2, len(joints))), base_velocity_ends=speeds,
    )  # fmt: skip


def test_the_zmp_of_a_robot_at_rest_is_below_its_centre_of_mass(any_robot: RobotModel) -> None:
    times = np.linspace(0.0, 1.0, 5)
    base = np.tile([0.3, -0.2, 0.4, 0.2, -0.15, 1.1], (5, 1))
    points = zero_moment_point(any_robot, locked(any_robot, base, times, np.zeros((2, 6))))
    com = any_robot.center_of_mass(base[0], bent(any_robot))
    assert points.com == pytest.approx(np.tile(com, (len(points.times), 1)), abs=1e-12)
    assert points.zmp == pytest.approx(np.tile(com[:2], (len(points.times), 1)), abs=1e-9)


def test_the_zmp_of_a_locked_robot_falls_back_by_height_times_acceleration_over_gravity(hexapod: RobotModel) -> None:
    times, a = np.linspace(0.0, 1.0, 9), np.array([0.7, -0.4, 0.5])
    base = np.zeros((9, 6))
    base[:, :3] = [0.0, 0.0, 0.2] + 0.5 * np.outer(times**2, a)
    base[:, 5] = 0.6
    speeds = np.zeros((2, 6))
    speeds[1, :3] = a
    points = zero_moment_point(hexapod, locked(hexapod, base, times, speeds))
    expected = points.com[:, :2] - np.outer(points.com[:, 2] / (GRAVITY + a[2]), a[:2])
    assert points.zmp == pytest.approx(expected, abs=1e-7)
    assert np.abs(points.zmp - points.com[:, :2]).max() > 0.005


def test_the_zmp_of_a_locked_robot_that_pitches_is_that_of_its_moment_of_inertia(hexapod: RobotModel) -> None:
    """Euler's equation about the y axis of a body that pitches about its own centre of mass."""
    times, alpha = np.linspace(0.0, 0.5, 9), 2.0
    still = locked(hexapod, np.zeros((9, 6)), times, np.zeros((2, 6)))
    joints = still.joint_positions[:, 0]
    pitch = 0.5 * alpha * times**2
    arm = hexapod.center_of_mass(np.zeros(6), joints)

    def pose(angle: float) -> np.ndarray:
        turn = pinocchio.rpy.rpyToMatrix(0.0, angle, 0.0)
        return np.array([*([0.0, 0.0, 0.3] - turn @ arm), 0.0, angle, 0.0])

    fine = np.linspace(0.0, 0.5, 401)
    base = np.array([pose(0.5 * alpha * t**2) for t in fine])
    end = (pose(0.5 * alpha * 0.5**2 + 1e-6) - pose(0.5 * alpha * 0.5**2 - 1e-6)) / 2e-6 * alpha * 0.5
    plan = locked(hexapod, base, fine, np.array([np.zeros(6), end]))
    points = zero_moment_point(hexapod, plan, per_interval=1)
    data = hexapod.pin.createData()
    pinocchio.ccrba(hexapod.pin, data, hexapod.configuration(pose(pitch[0]), joints), np.zeros(hexapod.pin.nv))
    inertia = data.Ig.inertia[1, 1]  # about y, which the pitching leaves where it is
    shift = -inertia * alpha / (hexapod.mass * GRAVITY)
    assert points.zmp[20:-20, 0] - points.com[20:-20, 0] == pytest.approx(np.full(361 - 1, shift), rel=2e-3)


def test_the_margin_is_the_distance_to_the_edge_that_shapely_measures(penta: MotionPlan, hexapod: RobotModel) -> None:
    points = zero_moment_point(hexapod, penta, per_interval=1)
    for t, zmp, margin in zip(points.times, points.zmp, points.margin, strict=True):
        stance = held(penta, np.array([t]))[0]
        hull = MultiPoint(hexapod.foot_positions(penta.base_spline(t), penta(t))[stance, :2]).convex_hull
        distance = hull.exterior.distance(Point(zmp))
        assert margin == pytest.approx(distance if hull.contains(Point(zmp)) else -distance, abs=1e-9)
