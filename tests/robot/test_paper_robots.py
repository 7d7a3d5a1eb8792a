"""The shipped robots: counts, geometry, masses, postures, and the same URDF every time."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest
import yaml

from gaitforge.resources import module_dirs, robot_files
from gaitforge.robot.load import load_robot
from gaitforge.robot.model import RobotModel

ROBOTS = ("hexapod", "dodecapod", "quadruped")


@pytest.fixture(scope="module", params=ROBOTS)
def robot(request: pytest.FixtureRequest) -> RobotModel:
    return load_robot(request.param)


def standing_base(robot: RobotModel) -> np.ndarray:
    return np.array([0.0, 0.0, robot.nominal.body_height, 0.0, 0.0, 0.0])


def with_limb(robot: RobotModel, limb: str, posture: np.ndarray) -> np.ndarray:
    """The standing posture with one limb in another."""
    q = robot.nominal.posture.copy()
    rows = robot.joint_indices(robot.limb(limb))
    q[rows] = posture[rows]
    return q


def test_every_shipped_robot_is_found_by_name() -> None:
    assert set(ROBOTS) <= set(robot_files())


@pytest.mark.parametrize(
    ("name", "modules", "limbs", "tools"),
    [
        ("hexapod", 20, 6, {"gripper_L1": "L1", "gripper_R1": "R1"}),
        ("dodecapod", 38, 12, {"gripper_L1": "L1", "gripper_R1": "R1", "camera": "R2"}),
        ("quadruped", 12, 4, {}),
    ],
)
def test_modules_limbs_and_tools_are_counted(name: str, modules: int, limbs: int, tools: dict[str, str]) -> None:
    robot = load_robot(name)
    assert robot.modules == len(robot.joint_names) == robot.pin.nv - 6 == modules
    assert len(robot.limbs) == limbs
    assert {t.name: t.limb for t in robot.tools} == tools
    assert all(len(limb.joints) == 3 for limb in robot.limbs)


def test_limbs_are_named_from_front_to_rear_on_the_side_where_they_are(robot: RobotModel) -> None:
    feet = robot.foot_positions(np.zeros(6), robot.nominal.posture)
    half = len(robot.limbs) // 2
    assert robot.limb_names == tuple(f"{s}{i + 1}" for s in "LR" for i in range(half))
    assert [x.side for x in robot.limbs] == ["left"] * half + ["right"] * half
    assert (feet[:half, 1] > 0.0).all()
    assert (feet[half:, 1] < 0.0).all()
    assert (np.diff(feet[:half, 0]) < 0.0).all()
    assert (np.diff(feet[half:, 0]) < 0.0).all()


def test_joints_are_in_the_order_of_limbs_and_no_joint_shares_a_name_with_a_link(robot: RobotModel) -> None:
    import yourdfpy

    expected = [f"{x.name}_J{k}" for x in robot.limbs for k in (1, 2, 3)]
    assert [j for j in robot.joint_names if "_J" in j] == expected
    for tool in robot.tools:
        for joint in tool.joints:
            assert joint == f"{tool.limb}_gripper"
            assert robot.joint_names.index(joint) == robot.joint_names.index(f"{tool.limb}_J3") + 1
    root = yourdfpy.URDF.load(_file(robot.urdf), build_scene_graph=False, load_meshes=False).robot
    assert {j.name for j in root.joints}.isdisjoint({x.name for x in root.links})
    assert len(root.joints) == len(robot.joint_names) <= 127
    assert {j.type for j in root.joints} == {"revolute"}
    assert all(x.inertial is not None and x.inertial.mass > 0.0 for x in root.links)


def _file(text: str):
    import io

    return io.BytesIO(text.encode())


def test_the_hexapods_legs_have_the_papers_lengths() -> None:
    robot = load_robot("hexapod")
    pose = [robot.link_pose(f"L2_link{k}", np.zeros(6), np.zeros(20))[:3, 3] for k in (1, 2, 3)]
    foot = robot.foot_positions(np.zeros(6), np.zeros(20))[1]
    assert np.linalg.norm(pose[1] - pose[0]) == pytest.approx(0.0639, abs=1e-9)
    assert np.linalg.norm(pose[2] - pose[1]) == pytest.approx(0.1139, abs=1e-9)
    assert foot - pose[2] == pytest.approx([0.0, 0.0718, -0.146], abs=1e-9)
    assert robot.nominal.body_height == pytest.approx(0.1333, abs=1e-9)
    walking = [robot.joint_names.index(j) for x in robot.limbs for j in x.joints]
    assert (robot.effort[walking] == 7.0).all()
    assert (robot.velocity == 2.208932).all()
    assert (robot.upper == 1.57).all()
    assert (robot.lower == -1.57).all()
    assert {robot.effort[robot.joint_names.index(f"{x}_gripper")] for x in ("L1", "R1")} == {1.5}


def test_masses_are_the_sums_of_the_modules() -> None:
    leg = 3 * 2 * 0.103 + 0.05 + 0.045 + 0.065
    assert 1.0 + 6 * leg == pytest.approx(5.67, abs=0.005), "the paper's robot without grippers"
    assert load_robot("hexapod").mass == pytest.approx(1.0 + 6 * leg + 2 * 0.206, abs=1e-9)
    assert load_robot("dodecapod").mass == pytest.approx(2.25 + 12 * leg + 2 * 0.206 + 0.02 + 0.05, abs=1e-9)
    dog = 0.480 + 0.215 + 0.500 + (0.199 + 0.4 * 0.25) + 0.480 + (0.212 + 0.4 * 0.23) + 0.060
    assert load_robot("quadruped").mass == pytest.approx(3.5 + 4 * dog, abs=1e-9)


def test_positive_lift_and_knee_angles_raise_a_foot_on_both_sides() -> None:
    robot = load_robot("dodecapod")
    rest = robot.foot_positions(np.zeros(6), np.zeros(38))
    for limb in robot.limbs:
        for joint in limb.joints[1:]:
            q = np.zeros(38)
            q[robot.joint_names.index(joint)] = 0.1
            assert robot.foot_positions(np.zeros(6), q)[robot.limbs.index(limb), 2] > rest[robot.limbs.index(limb), 2]


def test_a_standing_robot_has_all_feet_on_the_ground_around_its_centre_of_mass(robot: RobotModel) -> None:
    from shapely import Point, Polygon

    base, q = standing_base(robot), robot.nominal.posture
    feet = robot.foot_positions(base, q)
    assert feet[:, 2] == pytest.approx([x.foot.radius for x in robot.limbs], abs=1e-9)
    hull = Polygon(feet[:, :2]).convex_hull
    assert hull.exterior.distance(Point(robot.center_of_mass(base, q)[:2])) > 0.05
    assert hull.contains(Point(robot.center_of_mass(base, q)[:2]))


def test_a_held_limb_is_raised_and_clear_of_its_neighbours(robot: RobotModel) -> None:
    for limb in robot.limbs:
        q = with_limb(robot, limb.name, robot.nominal.held_posture)
        foot = robot.foot_positions(standing_base(robot), q)[robot.limbs.index(limb)]
        assert foot[2] - limb.foot.radius >= 0.08, limb.name
        for other in robot.limbs:
            if other is not limb:
                assert clearance(robot, q, limb.name, other.name) > 0.03, (limb.name, other.name)


def test_standing_limbs_are_clear_of_each_other(robot: RobotModel) -> None:
    pairs = [(a.name, b.name) for i, a in enumerate(robot.limbs) for b in robot.limbs[i + 1 :]]
    assert min(clearance(robot, robot.nominal.posture, *p) for p in pairs) > 0.05


def clearance(robot: RobotModel, q: np.ndarray, one: str, other: str) -> float:
    """Smallest distance between the capsules of two limbs, by sampling their axes [m]."""
    shapes = []
    for name in (one, other):
        links = robot.limb(name).links
        spheres = []
        for c in (c for c in robot.capsules if c.link in links):
            T = robot.link_pose(c.link, standing_base(robot), q)
            axis = np.linspace(c.a, c.b, 7) @ T[:3, :3].T + T[:3, 3]
            spheres.append(np.column_stack([axis, np.full(len(axis), c.radius)]))
        shapes.append(np.concatenate(spheres))
    a, b = shapes
    gaps = np.linalg.norm(a[:, None, :3] - b[None, :, :3], axis=2) - a[:, None, 3] - b[None, :, 3]
    return float(gaps.min())


def test_the_camera_looks_level_and_straight_ahead_over_the_front_limbs() -> None:
    robot = load_robot("dodecapod")
    camera = robot.tool("R2")
    assert camera is not None
    assert camera.limb == robot.limb("camera").name == "R2"
    q = with_limb(robot, "R2", robot.nominal.held_posture)
    T = robot.link_pose(camera.link, standing_base(robot), q) @ camera.T_link_tool
    assert T[:3, 2] == pytest.approx([1.0, 0.0, 0.0], abs=1e-4), "optical axis ahead"
    assert T[:3, 0] == pytest.approx([0.0, -1.0, 0.0], abs=1e-4), "image x to the right"
    assert 0.30 <= T[2, 3] <= 0.41


def test_the_camera_limb_is_clear_of_its_walking_neighbours_also_when_it_turns_to_a_target() -> None:
    robot = load_robot("dodecapod")
    for inward in (0.0, 0.17):
        raised = with_limb(robot, "R2", robot.nominal.held_posture)
        raised[robot.joint_names.index("R2_J1")] -= inward
        for neighbour in ("R1", "R3"):
            for swing in (-0.15, 0.0, 0.15):
                for lift, knee in ((0.0, 0.0), (0.25, -0.1)):
                    q = raised.copy()
                    q[robot.joint_indices(robot.limb(neighbour))] += (swing, lift, knee)
                    assert clearance(robot, q, "R2", neighbour) > 0.04


def test_a_three_legged_stand_of_the_quadruped_stays_below_60_percent_of_the_efforts() -> None:
    """Worst foot forces that hold the robot up on three legs, gravity of the limbs included."""
    import pinocchio
    from scipy.optimize import linprog

    robot = load_robot("quadruped")
    base, q0 = standing_base(robot), robot.nominal.posture
    q = robot.configuration(base, q0)
    data = robot.pin.createData()
    gravity = pinocchio.computeGeneralizedGravity(robot.pin, data, q)
    feet, com = robot.foot_positions(base, q0), robot.center_of_mass(base, q0)
    for lifted in range(4):
        legs = [i for i in range(4) if i != lifted]
        shift = feet[legs, :2].mean(axis=0) - com[:2]  # the body is moved over the triangle before a leg is lifted
        A = np.vstack([np.ones(3), (feet[legs, :2] - shift - com[:2]).T])
        weight = robot.mass * 9.81
        forces = linprog(np.zeros(3), A_eq=A, b_eq=[weight, 0.0, 0.0], bounds=(0.0, weight)).x
        torque = gravity.copy()
        for i, force in zip(legs, forces, strict=True):
            J = _foot_jacobian(robot, q, i)
            torque -= J.T @ np.array([0.0, 0.0, force])
        rows = robot._q_index - 1
        assert (np.abs(torque[rows]) < 0.6 * robot.effort).all(), torque[rows] / robot.effort


def _foot_jacobian(robot: RobotModel, q: np.ndarray, index: int) -> np.ndarray:
    """(3, nv) by central differences on the manifold."""
    import pinocchio

    def foot(v: np.ndarray) -> np.ndarray:
        data = robot.pin.createData()
        pinocchio.framesForwardKinematics(robot.pin, data, pinocchio.integrate(robot.pin, q, v))
        limb = robot.limbs[index]
        frame = robot.pin.getFrameId(limb.foot.link, pinocchio.FrameType.BODY)
        return np.array(data.oMf[frame].act(np.array(limb.foot.offset)))

    step = 1e-6 * np.eye(robot.pin.nv)
    return np.array([(foot(v) - foot(-v)) / 2e-6 for v in step]).T


def test_the_urdf_is_the_same_to_the_byte_in_every_process() -> None:
    code = f"from gaitforge.robot.load import load_robot\nfor name in {ROBOTS}: print(load_robot(name).urdf)"
    texts = []
    for seed in ("1", "2"):
        environment = {**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
        run = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, check=True)
        texts.append(run.stdout)
    assert texts[0] == texts[1]
    assert texts[0].count(b"<robot ") == 3


@pytest.mark.parametrize("family", ["cmu_sea", "hebi"])
def test_every_module_of_the_catalogue_loads_and_names_its_source(family: str) -> None:
    from gaitforge.robot.module_read import load_module

    files = sorted(module_dirs()[family].glob("*.yaml"))
    assert len(files) >= 8
    for file in files:
        module = load_module(file)
        assert module.name == file.stem == yaml.safe_load(file.read_text(encoding="utf-8"))["name"]
        assert len(module.source) > 10
        if module.mirror:
            assert load_module(module_dirs()[family] / f"{module.mirror}.yaml").mirror == module.name
