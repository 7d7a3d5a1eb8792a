"""Loads: the robot that carries one weighs more, everywhere and in every engine."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio
import pybullet
import pytest

import gaitforge as gf
from gaitforge.errors import InputError
from gaitforge.robot.kinematics import base_body, evaluate_limb, limb_parameters
from gaitforge.robot.model import RobotModel

BOX = gf.Load(0.5, (0.3, 0.05, 0.1))
POSE = np.array([0.1, -0.2, 0.15, 0.05, -0.1, 0.4])


@pytest.fixture(scope="module")
def robot() -> RobotModel:
    return gf.load_robot("hexapod")


def bent(robot: RobotModel) -> np.ndarray:
    return robot.nominal.posture + np.random.default_rng(3).normal(0.0, 0.2, len(robot.joint_names))


def place(robot: RobotModel, load: gf.Load, q: np.ndarray) -> np.ndarray:
    """(3,) the load in the world by the frames of the empty robot."""
    if load.frame == "body":
        return (robot.link_pose(robot.base_link, POSE, q) @ np.append(load.point, 1.0))[:3]
    tool = next((t for t in robot.tools if t.name == load.frame), None)
    link = robot.limb(load.frame).foot.link if tool is None else tool.link
    inner = np.eye(4) if tool is None else tool.T_link_tool
    return (robot.link_pose(link, POSE, q) @ inner @ np.append(load.point, 1.0))[:3]


@pytest.mark.parametrize("frame", ["body", "L2", "gripper_R1"])
def test_a_load_is_in_the_centre_of_mass_of_the_robot(robot: RobotModel, frame: str) -> None:
    load, q = gf.Load(0.7, (0.05, 0.02, -0.03), frame), bent(robot)
    laden = robot.carrying(load)
    assert laden.mass == pytest.approx(robot.mass + 0.7, abs=1e-9)
    expected = robot.mass * robot.center_of_mass(POSE, q) + 0.7 * place(robot, load, q)
    assert laden.mass * laden.center_of_mass(POSE, q) == pytest.approx(expected, abs=1e-9)


def test_kinetic_energy_of_the_laden_robot_is_that_of_robot_and_ball(robot: RobotModel) -> None:
    """Inertias about every axis: against the frame velocity that Pinocchio gives for the load's place."""
    laden, q = robot.carrying(BOX), bent(robot)
    v = np.random.default_rng(5).normal(0.0, 1.0, robot.pin.nv)
    data = robot.pin.createData()
    configuration = robot.configuration(POSE, q)
    pinocchio.forwardKinematics(robot.pin, data, configuration, v)
    turn, omega = data.oMi[1].rotation, v[3:6]
    speed = turn @ (v[:3] + np.cross(omega, BOX.point))
    ball = 0.5 * BOX.mass * speed @ speed + 0.5 * BOX.inertia[0, 0] * omega @ omega
    own = pinocchio.computeKineticEnergy(robot.pin, data, configuration, v)
    assert pinocchio.computeKineticEnergy(laden.pin, laden.pin.createData(), configuration, v) == pytest.approx(
        own + ball, rel=1e-9
    )


def test_the_symbolic_limbs_weigh_their_loads(robot: RobotModel) -> None:
    laden, q = robot.carrying(gf.Load(0.3, (0.0, 0.0, 0.02), "R3"), BOX), bent(robot)
    for limb in robot.limbs:
        for name in limb.tool_joints:  # the limb kernel takes them at their nominal place
            q[robot.joint_names.index(name)] = robot.nominal.posture[robot.joint_names.index(name)]
    mass, moment = base_body(laden)
    for limb in laden.limbs:
        parameters = limb_parameters(laden, limb)
        moment = moment + evaluate_limb(q[None, laden.joint_indices(limb)], parameters).moment[0]
    assert moment == pytest.approx(laden.mass * laden.center_of_mass(np.zeros(6), q), abs=1e-9)
    assert mass == pytest.approx(base_body(robot)[0] + BOX.mass, abs=1e-9)


def test_a_robot_carries_what_it_was_told_last(robot: RobotModel) -> None:
    other = gf.Load(0.2, (0.0, 0.0, 0.1))
    laden = robot.carrying(BOX)
    assert laden.carrying(BOX) is laden
    assert laden.carrying(other).mass == pytest.approx(robot.mass + 0.2)
    assert laden.carrying() is robot
    assert robot.carrying(BOX, other).mass == pytest.approx(robot.mass + 0.7)


def test_a_load_on_nothing_is_refused(robot: RobotModel) -> None:
    with pytest.raises(InputError, match=r"load\.frame: found 'L9'; expected one of body, L1"):
        robot.carrying(gf.Load(0.5, (0.0, 0.0, 0.0), "L9"))


@pytest.mark.parametrize("mass", [0.0, -1.0, float("nan")])
def test_a_load_weighs_something(mass: float) -> None:
    with pytest.raises(ValueError, match="mass > 0"):
        gf.Load(mass, (0.0, 0.0, 0.0))


def test_pybullet_weighs_the_load(robot: RobotModel, tmp_path: Path) -> None:
    path = tmp_path / "laden.urdf"
    path.write_text(robot.carrying(BOX).urdf)
    client = pybullet.connect(pybullet.DIRECT)
    body = pybullet.loadURDF(str(path), flags=pybullet.URDF_USE_INERTIA_FROM_FILE, physicsClientId=client)
    links = range(-1, pybullet.getNumJoints(body, physicsClientId=client))
    mass = sum(pybullet.getDynamicsInfo(body, i, physicsClientId=client)[0] for i in links)
    pybullet.disconnect(client)
    assert mass == pytest.approx(robot.mass + BOX.mass, rel=1e-9)
