"""Pinocchio, PyBullet and a forward kinematics written by hand agree about masses and feet."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gaitforge.robot.load import load_robot
from gaitforge.robot.model import RobotModel

BODY = {"hexapod": (0.125, 3), "dodecapod": (0.3125, 6)}  # x of the first ports, limbs a side


def sea_foot(side: int, port_x: float, q: np.ndarray) -> np.ndarray:
    """Foot of a series-elastic leg from its published lengths; side +1 left, −1 right; base frame [m]."""
    yaw = side * np.pi / 2 - q[0]
    out = 0.0639 + 0.1139 * np.cos(q[1]) + 0.0718 * np.cos(q[1] + q[2]) + 0.146 * np.sin(q[1] + q[2])
    up = 0.1139 * np.sin(q[1]) + 0.0718 * np.sin(q[1] + q[2]) - 0.146 * np.cos(q[1] + q[2])
    shoulder = np.array([port_x, side * (0.0925 + 0.0366), 0.0381])
    return shoulder + np.array([out * np.cos(yaw), out * np.sin(yaw), up])


def dog_foot(limb: str, q: np.ndarray) -> np.ndarray:
    """Foot of the quadruped: L1 by trigonometry, the others its mirror image or half a turn of it."""
    if limb in ("R1", "L2"):
        image = np.array([1.0, -1.0, 1.0]) if limb == "R1" else np.array([-1.0, 1.0, 1.0])
        return image * dog_foot("L1", -q)
    if limb == "R2":
        return np.array([-1.0, -1.0, 1.0]) * dog_foot("L1", q)
    x = -0.25 * np.sin(q[1]) - 0.25 * np.sin(q[1] - q[2])
    z = -0.25 * np.cos(q[1]) - 0.25 * np.cos(q[1] - q[2])
    y = 0.0375 + 0.0451 + 0.02 - 0.02 - 0.0451 - 0.02
    roll = np.array([[1, 0, 0], [0, np.cos(q[0]), -np.sin(q[0])], [0, np.sin(q[0]), np.cos(q[0])]])
    return np.array([0.15 + 0.0451 + 0.055, 0.1, 0.0]) + roll @ np.array([x, y, z])


def by_hand(robot: RobotModel, q: np.ndarray) -> np.ndarray:
    """(n_F, 3) feet in the base frame, from no code of gaitforge."""
    feet = []
    for limb in robot.limbs:
        own = q[robot.joint_indices(limb)]
        if robot.name == "quadruped":
            feet.append(dog_foot(limb.name, own))
        else:
            first, _ = BODY[robot.name]
            side = 1 if limb.name[0] == "L" else -1
            feet.append(sea_foot(side, first - 0.125 * (int(limb.name[1:]) - 1), own))
    return np.array(feet)


@pytest.fixture(params=["hexapod", "dodecapod", "quadruped"])
def loaded(request: pytest.FixtureRequest, tmp_path: Path):
    import pybullet as p

    robot = load_robot(request.param)
    file = tmp_path / "robot.urdf"
    file.write_text(robot.urdf, encoding="utf-8")
    client = p.connect(p.DIRECT)
    body = p.loadURDF(str(file), flags=p.URDF_USE_INERTIA_FROM_FILE, physicsClientId=client)
    yield robot, client, body
    p.disconnect(client)


def test_both_weigh_what_the_modules_weigh(loaded) -> None:
    import pybullet as p

    robot, client, body = loaded
    joints = p.getNumJoints(body, physicsClientId=client)
    masses = [p.getDynamicsInfo(body, i, physicsClientId=client)[0] for i in range(-1, joints)]
    assert joints == len(robot.joint_names)
    assert sum(masses) == pytest.approx(robot.mass, abs=1e-9)


def test_feet_are_where_trigonometry_puts_them(loaded) -> None:
    import pybullet as p

    robot, client, body = loaded
    index = {p.getJointInfo(body, i, physicsClientId=client)[1].decode(): i for i in range(len(robot.joint_names))}
    link = {p.getJointInfo(body, i, physicsClientId=client)[12].decode(): i for i in index.values()}
    place_base(p, body, 0.0, client)
    random = np.random.default_rng(7)
    for _ in range(20):
        q = random.uniform(robot.lower, robot.upper)
        for name, angle in zip(robot.joint_names, q, strict=True):
            p.resetJointState(body, index[name], angle, physicsClientId=client)
        bullet = []
        for limb in robot.limbs:
            state = p.getLinkState(body, link[limb.foot.link], computeForwardKinematics=True, physicsClientId=client)
            bullet.append(p.multiplyTransforms(state[4], state[5], limb.foot.offset, [0, 0, 0, 1])[0])
        expected = by_hand(robot, q)
        assert np.abs(robot.foot_positions(np.zeros(6), q) - expected).max() < 1e-6
        assert np.abs(np.array(bullet) - expected).max() < 1e-6


def test_nothing_but_the_feet_touches_anything_when_standing(loaded) -> None:
    """Standing in PyBullet with self-collision: every foot carries, no limb touches the ground or another limb."""
    import pybullet as p

    robot, client, _ = loaded
    p.resetSimulation(physicsClientId=client)
    p.setGravity(0, 0, -9.81, physicsClientId=client)
    plane = p.createCollisionShape(p.GEOM_PLANE, physicsClientId=client)
    ground = p.createMultiBody(0, plane, physicsClientId=client)
    body = _spawn(p, robot, client)
    for index, target in enumerate(_in_bullet_order(p, robot, body, client)):
        p.resetJointState(body, index, target, physicsClientId=client)
        p.setJointMotorControl2(
            body, index, p.POSITION_CONTROL, target, positionGain=0.3, force=50.0, physicsClientId=client
        )
    for _ in range(120):
        p.stepSimulation(physicsClientId=client)
    names = {i: p.getJointInfo(body, i, physicsClientId=client)[12].decode() for i in range(len(robot.joint_names))}
    touching = {names.get(c[3], "base_link") for c in p.getContactPoints(body, ground, physicsClientId=client)}
    assert touching == {x.foot.link for x in robot.limbs}
    assert not [c for c in p.getContactPoints(body, body, physicsClientId=client) if c[9] > 0.0]


def _spawn(p, robot: RobotModel, client: int) -> int:
    import tempfile

    with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
        file.write(robot.urdf)
        file.flush()
        flags = p.URDF_USE_INERTIA_FROM_FILE | p.URDF_USE_SELF_COLLISION
        body = p.loadURDF(file.name, flags=flags, physicsClientId=client)
    place_base(p, body, robot.nominal.body_height, client)
    return int(body)


def place_base(p, body: int, height: float, client: int) -> None:
    """base_link level at a height; PyBullet's base pose is the one of its centre of mass and principal axes."""
    info = p.getDynamicsInfo(body, -1, physicsClientId=client)
    com = [info[3][0], info[3][1], info[3][2] + height]
    p.resetBasePositionAndOrientation(body, com, info[4], physicsClientId=client)


def _in_bullet_order(p, robot: RobotModel, body: int, client: int) -> list[float]:
    posture = dict(zip(robot.joint_names, robot.nominal.posture, strict=True))
    count = len(robot.joint_names)
    return [posture[p.getJointInfo(body, i, physicsClientId=client)[1].decode()] for i in range(count)]
