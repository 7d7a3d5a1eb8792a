"""The limb kinematics in CasADi against Pinocchio's own."""

from __future__ import annotations

from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pinocchio
import pytest

from gaitforge.errors import InputError
from gaitforge.robot.kinematics import base_body, evaluate_limb, limb_parameters, rpy_rotation
from gaitforge.robot.load import load_robot
from gaitforge.robot.model import RobotModel

EXACT = 1e-9
COUNT = 20


@pytest.fixture(scope="module", params=["hexapod", "quadruped", "dodecapod"])
def robot(request: pytest.FixtureRequest) -> RobotModel:
    return load_robot(request.param)


def random_configurations(robot: RobotModel, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """(n, 6) base poses anywhere and (n, n_J) joints within limits; tool joints as the kinematics take them to be."""
    rng = np.random.default_rng(seed)
    base = rng.uniform(-1.0, 1.0, (COUNT, 6)) * [2.0, 2.0, 2.0, 3.0, 1.4, 3.0]
    joints = rng.uniform(robot.lower, robot.upper, (COUNT, len(robot.joint_names)))
    tools = [robot.joint_names.index(name) for limb in robot.limbs for name in limb.tool_joints]
    joints[:, tools] = robot.nominal.posture[tools]
    return base, joints


def placed(robot: RobotModel, base: np.ndarray, joints: np.ndarray) -> pinocchio.Data:
    """Pinocchio's frames of one configuration, made here from a quaternion."""
    q = pinocchio.neutral(robot.pin)
    q[:3] = base[:3]
    z, y, x = (pinocchio.utils.rotate(axis, base[k]) for axis, k in (("z", 5), ("y", 4), ("x", 3)))
    q[3:7] = pinocchio.Quaternion(z @ y @ x).coeffs()
    for name, angle in zip(robot.joint_names, joints, strict=True):
        q[robot.pin.joints[robot.pin.getJointId(name)].idx_q] = angle
    data = robot.pin.createData()
    pinocchio.framesForwardKinematics(robot.pin, data, q)
    pinocchio.centerOfMass(robot.pin, data, q)
    return data


def rotation_of(base: np.ndarray) -> np.ndarray:
    """R of a base pose by the CasADi expression."""
    import casadi as ca

    return np.array(ca.DM(rpy_rotation(ca.DM(base[3:6]))))


def test_feet_and_foot_links_are_where_pinocchio_puts_them(robot: RobotModel) -> None:
    base, joints = random_configurations(robot)
    for limb in robot.limbs:
        ours = evaluate_limb(joints[:, robot.joint_indices(limb)], limb_parameters(robot, limb))
        frame = robot.pin.getFrameId(limb.foot.link, pinocchio.FrameType.BODY)
        last = robot.pin.getJointId(limb.joints[-1])
        for k in range(COUNT):
            data, turn = placed(robot, base[k], joints[k]), rotation_of(base[k])
            foot = data.oMf[frame].act(np.array(limb.foot.offset))
            assert base[k, :3] + turn @ ours.foot[k] == pytest.approx(foot, abs=EXACT)
            assert turn @ ours.rotation[k] == pytest.approx(data.oMi[last].rotation, abs=EXACT)


def test_every_joint_of_a_limb_is_where_pinocchio_puts_it(robot: RobotModel) -> None:
    base, joints = random_configurations(robot, seed=2)
    for limb in robot.limbs:
        ours = evaluate_limb(joints[:, robot.joint_indices(limb)], limb_parameters(robot, limb))
        for k in range(COUNT):
            data, turn = placed(robot, base[k], joints[k]), rotation_of(base[k])
            for j, name in enumerate(limb.joints):
                there = data.oMi[robot.pin.getJointId(name)]
                assert base[k, :3] + turn @ ours.origins[k, j] == pytest.approx(there.translation, abs=EXACT)
                assert turn @ ours.turns[k, j] == pytest.approx(there.rotation, abs=EXACT)


def test_the_limbs_moments_and_the_base_make_the_centre_of_mass(robot: RobotModel) -> None:
    base, joints = random_configurations(robot, seed=3)
    parameters = {limb.name: limb_parameters(robot, limb) for limb in robot.limbs}
    _, own = base_body(robot)
    for k in range(COUNT):
        moment = own + sum(
            evaluate_limb(joints[k : k + 1, robot.joint_indices(limb)], parameters[limb.name]).moment[0]
            for limb in robot.limbs
        )
        com = base[k, :3] + rotation_of(base[k]) @ moment / robot.mass
        data = placed(robot, base[k], joints[k])
        assert com == pytest.approx(np.array(data.com[0]), abs=EXACT)


def test_a_tool_joint_is_weighed_where_its_nominal_position_puts_it() -> None:
    hexapod = load_robot("hexapod")
    limb = hexapod.limb("L1")
    (tool_joint,) = limb.tool_joints
    tree = ElementTree.fromstring(hexapod.urdf)
    tree.find(f"link[@name='{hexapod.tools[0].link}']/inertial/origin").set("xyz", "0.03 0.02 0.01")  # off its axis
    turned = hexapod.nominal.posture.copy()
    turned[hexapod.joint_names.index(tool_joint)] += 0.5
    robots = [replace(hexapod, urdf=ElementTree.tostring(tree, encoding="unicode"))]
    robots.append(replace(robots[0], nominal=replace(hexapod.nominal, posture=turned)))
    joints = np.where(np.isin(hexapod.joint_names, limb.joints), 0.1, turned)
    ours, theirs = [], []
    for robot in robots:
        ours.append(evaluate_limb(np.full((1, 3), 0.1), limb_parameters(robot, robot.limb("L1"))).moment[0])
        joints[hexapod.joint_names.index(tool_joint)] = robot.nominal.posture[hexapod.joint_names.index(tool_joint)]
        data = placed(robot, np.zeros(6), joints)
        theirs.append(np.array(data.com[0]) * robot.mass)
    assert ours[1] - ours[0] == pytest.approx(theirs[1] - theirs[0], abs=EXACT)
    assert np.linalg.norm(ours[1] - ours[0]) > 1e-4


def test_rates_of_roll_pitch_yaw_are_pinocchios_velocity(robot: RobotModel) -> None:
    rng = np.random.default_rng(4)
    base, joints = random_configurations(robot, seed=4)
    step = 1e-6
    for k in range(COUNT):
        rate, speed = rng.normal(size=6), rng.normal(size=len(robot.joint_names))
        before, after = (
            robot.configuration(base[k] + s * step * rate, joints[k] + s * step * speed) for s in (-1.0, 1.0)
        )
        expected = pinocchio.difference(robot.pin, before, after) / (2 * step)
        assert robot.velocity_vector(base[k], rate, speed) == pytest.approx(expected, abs=1e-7)


def test_a_limb_whose_joints_are_no_chain_from_the_base_is_refused(robot: RobotModel) -> None:
    limb = robot.limbs[0]
    with pytest.raises(InputError, match="a chain from the base"):
        limb_parameters(robot, replace(limb, joints=limb.joints[1:]))


def test_a_foot_that_the_last_joint_does_not_move_is_refused(robot: RobotModel) -> None:
    limb = robot.limbs[0]
    with pytest.raises(InputError, match="a foot that the last joint does not move"):
        limb_parameters(robot, replace(limb, foot=replace(limb.foot, link=robot.base_link)))


def test_a_prismatic_joint_is_refused() -> None:
    robot = load_robot("quadruped")
    name = robot.limbs[0].joints[1]
    head, _, tail = robot.urdf.partition(f'<joint name="{name}" type="revolute"')
    assert tail
    sliding = replace(robot, urdf=f'{head}<joint name="{name}" type="prismatic"{tail}')
    with pytest.raises(InputError, match="expected a revolute joint"):
        limb_parameters(sliding, sliding.limbs[0])
