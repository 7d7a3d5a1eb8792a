"""What PyBullet is told, and what it makes of it."""

import numpy as np
import pytest
from walkers import HEIGHT, LINK_KG, posture, urdf, walker

from gaitforge.errors import InputError, SimulationError
from gaitforge.robot.model import RobotModel
from gaitforge.task.scene import Scene, SceneObject
from gaitforge.verify.pybullet import PyBulletSimulator
from gaitforge.verify.pybullet.client import direct_client, quiet
from gaitforge.verify.pybullet.world import add_object, build_world

LOPSIDED = (0.03, -0.02, 0.01)  # [m] centre of mass of the trunk in base_link
BASE = np.array([0.3, -0.2, 0.5, 0.2, -0.3, 0.8])


def test_base_poses_are_those_of_base_link_although_pybullet_speaks_of_the_centre_of_mass() -> None:
    robot = walker(2, urdf=urdf(2, LOPSIDED))
    with direct_client("test") as (p, client):
        world = build_world(p, client, robot, Scene(), 1.0)
        world.place_robot(BASE, posture(2))
        position, xyzw = (np.array([v]) for v in p.getBasePositionAndOrientation(world.robot, physicsClientId=client))
        omega, linear = np.array([[0.1, 0.2, -0.4]]), np.array([[0.5, 0.0, 0.1]])
        poses, twists = world.base_states(position, xyzw, linear, omega)
        feet = np.array([world.link_pose(limb.foot.link)[1] for limb in robot.limbs])
    assert np.linalg.norm(position[0] - BASE[:3]) == pytest.approx(np.linalg.norm(LOPSIDED))
    np.testing.assert_allclose(poses[0], BASE, atol=1e-9)
    np.testing.assert_allclose(twists[0, :3], linear[0] + np.cross(omega[0], BASE[:3] - position[0]), atol=1e-9)
    expected = [robot.link_pose(limb.foot.link, BASE, posture(2))[:3, 3] for limb in robot.limbs]
    np.testing.assert_allclose(feet, expected, atol=1e-6)


def slid(angle_deg: float, azimuth_deg: float, friction: float) -> float:
    """Path [m] in half a second of a block on a slope, friction 1 on the ground and `friction` on the block."""
    with direct_client("test") as (p, client):
        p.setPhysicsEngineParameter(
            fixedTimeStep=1 / 240, numSolverIterations=100, enableConeFriction=0, physicsClientId=client
        )
        a, z = np.radians([angle_deg, azimuth_deg])
        gravity = 9.81 * np.array([np.sin(a) * np.cos(z), np.sin(a) * np.sin(z), -np.cos(a)])
        p.setGravity(*gravity, physicsClientId=client)
        ground = p.createMultiBody(
            0, p.createCollisionShape(p.GEOM_PLANE, physicsClientId=client), physicsClientId=client
        )
        p.changeDynamics(ground, -1, lateralFriction=1.0, physicsClientId=client)
        block = add_object(p, client, SceneObject("block", "box", (0, 0, 0.025), size=(0.4, 0.4, 0.05), mass=1.0))
        p.changeDynamics(block, -1, lateralFriction=friction, linearDamping=0, physicsClientId=client)
        for _ in range(120):
            p.stepSimulation(physicsClientId=client)
        return float(np.hypot(*p.getBasePositionAndOrientation(block, physicsClientId=client)[0][:2]))


@pytest.mark.parametrize("azimuth_deg", [0.0, 20.0, 45.0])
def test_no_direction_grips_more_than_the_stated_friction_and_none_less_than_the_pyramid_inside_it(
    azimuth_deg: float,
) -> None:
    pair = PyBulletSimulator(friction=1.0).pair_friction
    assert slid(34.0, azimuth_deg, pair) < 1e-3  # tan 35.3° = 1/√2
    assert slid(46.0, azimuth_deg, pair) > 1e-2  # tan 45° = 1


def test_the_friction_of_a_pair_is_the_product_of_its_two_coefficients() -> None:
    assert slid(20.0, 0.0, 0.5) < 1e-3  # tan 26.6° = 0.5 · 1
    assert slid(30.0, 0.0, 0.5) > 1e-2


def test_the_cone_takes_the_stated_friction_as_it_is() -> None:
    assert PyBulletSimulator(friction=0.8, friction_cone=True).pair_friction == 0.8


def test_a_robot_that_pybullet_makes_heavier_is_refused() -> None:
    weightless = (
        '<link name="tail"/><joint name="t" type="fixed"><parent link="base_link"/><child link="tail"/></joint>'
    )
    robot = walker(2, urdf=urdf(2).replace("</robot>", weightless + "</robot>"))
    with pytest.raises(SimulationError, match="kg in PyBullet"), direct_client("test") as (p, client):
        build_world(p, client, robot, Scene(), 1.0)


def test_a_robot_of_128_joints_is_refused_with_the_reason() -> None:
    inertia = (
        '<inertial><mass value="1e-3"/><inertia ixx="1e-6" iyy="1e-6" izz="1e-6" ixy="0" ixz="0" iyz="0"/></inertial>'
    )
    more = "".join(
        f'<link name="x{k}">{inertia}</link><joint name="xj{k}" type="fixed"><parent link="base_link"/>'
        f'<child link="x{k}"/></joint>'
        for k in range(128 - 12)
    )
    robot = walker(2, urdf=urdf(2).replace("</robot>", more + "</robot>"))
    with pytest.raises(SimulationError, match="at most 127 joints, found 128"), direct_client("test") as (p, client):
        build_world(p, client, robot, Scene(), 1.0)


def test_a_missing_mesh_is_a_simulation_error() -> None:
    mesh = '<visual><geometry><mesh filename="nowhere.stl"/></geometry></visual></link>'
    robot = walker(2, urdf=urdf(2).replace("</link>", mesh, 1))
    with pytest.raises(SimulationError, match="does not load the URDF"), direct_client("test") as (p, client):
        build_world(p, client, robot, Scene(), 1.0)


def test_nothing_is_printed_when_a_world_is_built(capfd: pytest.CaptureFixture[str]) -> None:
    with direct_client("test") as (p, client):
        build_world(p, client, walker(2), Scene(), 1.0)
    assert capfd.readouterr() == ("", "")


def test_quiet_gives_back_what_c_code_said_and_lets_python_speak_again(capfd: pytest.CaptureFixture[str]) -> None:
    import os

    with quiet() as said:
        os.write(1, b"from below\n")
        said.seek(0)
        assert said.read() == b"from below\n"
    print("from above", flush=True)
    assert capfd.readouterr().out == "from above\n"


def test_no_joint_but_the_commanded_ones_has_a_motor() -> None:
    robot = walker(2)
    with direct_client("test") as (p, client):
        world = build_world(p, client, robot, Scene(), 1.0)
        world.place_robot([0, 0, 1.0, 0, 0, 0], posture(2))
        p.setGravity(0, 0, 0, physicsClientId=client)
        first = world.joints[0]
        p.resetJointState(world.robot, first, 0.0, 1.0, physicsClientId=client)
        for _ in range(24):
            p.stepSimulation(physicsClientId=client)
        assert p.getJointState(world.robot, first, physicsClientId=client)[0] > 0.05


def test_links_weigh_what_the_file_says_and_their_order_is_known() -> None:
    robot = walker(2)
    with direct_client("test") as (p, client):
        world = build_world(p, client, robot, Scene(), 1.0)
        info = p.getDynamicsInfo(world.robot, world.links.index("R2_tibia") - 1, physicsClientId=client)
    assert info[0] == pytest.approx(LINK_KG)
    assert world.links[0] == "base_link"
    assert set(world.links) == {"base_link", *(link for limb in robot.limbs for link in limb.links)}


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("rate_hz", 0.0),
        ("position_gain", -1.0),
        ("friction", -0.1),
        ("solver_iterations", 0),
        ("solver_residual", -1e-3),
        ("camera_size", (0, 9)),
    ],
)
def test_settings_that_make_no_sense_are_refused_by_name(key: str, value: object) -> None:
    with pytest.raises(InputError, match=key):
        PyBulletSimulator(**{key: value})  # type: ignore[arg-type]


def test_all_bad_settings_are_reported_at_once() -> None:
    with pytest.raises(InputError) as caught:
        PyBulletSimulator(rate_hz=0.0, settle_s=-1.0)
    assert len(caught.value.problems) == 2


def test_the_config_file_names_every_setting_and_its_default() -> None:
    from dataclasses import asdict
    from pathlib import Path

    import yaml

    text = (Path(__file__).parents[2] / "conf" / "verify" / "pybullet.yaml").read_text()
    settings = yaml.safe_load(text)
    assert settings.pop("_target_") == "gaitforge.verify.pybullet.PyBulletSimulator"
    default = asdict(PyBulletSimulator())
    del default["name"]
    assert settings | {"camera_size": tuple(settings["camera_size"])} == default
    lines = [line for line in text.splitlines() if ":" in line and not line.startswith(("#", "_target_"))]
    assert all("#" in line for line in lines)


def test_a_pipe_is_hollow_and_its_wall_is_solid() -> None:
    pipe = SceneObject("pipe", "pipe", (1.0, 0.0, 0.3), (0.0, 0.0, 0.4), radius=0.1, length=0.5)
    with direct_client("test") as (p, client):
        body = add_object(p, client, pipe)
        axis = np.array([np.cos(0.4), np.sin(0.4), 0.0])
        left = np.array([-np.sin(0.4), np.cos(0.4), 0.0])
        opening = np.array(pipe.xyz)

        def hit(start: np.ndarray, end: np.ndarray) -> int:
            return int(p.rayTest(start, end, physicsClientId=client)[0][0])

        assert hit(opening - axis, opening + axis) == -1
        assert hit(opening - axis + 0.097 * left, opening + axis + 0.097 * left) == body
        assert hit(opening + 0.25 * axis + left, opening + 0.25 * axis) == body
        assert hit(opening - 0.01 * axis + left, opening - 0.01 * axis) == -1


def test_the_model_and_pybullet_agree_on_every_link_of_a_posture() -> None:
    robot: RobotModel = walker(3)
    pose = np.array([0.0, 0.0, HEIGHT, 0.1, 0.05, -0.4])
    with direct_client("test") as (p, client):
        world = build_world(p, client, robot, Scene(), 1.0)
        world.place_robot(pose, posture(3))
        for link in world.links:
            R, origin = world.link_pose(link)
            expected = robot.link_pose(link, pose, posture(3))
            np.testing.assert_allclose(np.column_stack([R, origin]), expected[:3], atol=1e-6)
