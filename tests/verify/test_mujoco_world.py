"""What MuJoCo is told, and what it makes of it."""

import subprocess
import sys
from dataclasses import asdict, replace
from pathlib import Path

import mujoco
import numpy as np
import pinocchio
import pytest
import trimesh
import yaml
from walkers import HEIGHT, posture, stand_plan, timeline_of, tripod_plan, urdf, walker

from gaitforge.errors import InputError, SimulationError
from gaitforge.motion.timeline import TimelineSamples
from gaitforge.robot.load import load_robot
from gaitforge.robot.model import RobotModel
from gaitforge.task.scene import Scene, SceneObject
from gaitforge.verify.execution import planned_rows
from gaitforge.verify.mujoco import MujocoSimulator
from gaitforge.verify.mujoco.recorder import robot_contacts
from gaitforge.verify.mujoco.world import World, build_world
from gaitforge.verify.verify import verify_timeline

LOPSIDED = (0.03, -0.02, 0.01)  # [m] centre of mass of the trunk in base_link
BASE = np.array([0.3, -0.2, 0.5, 0.2, -0.3, 0.8])


def world_of(robot: RobotModel, *objects: SceneObject, **settings: float) -> World:
    return build_world(robot, Scene(objects), MujocoSimulator(**settings).physics())


@pytest.mark.parametrize("name", ["hexapod", "dodecapod", "quadruped"])
def test_mass_and_mass_matrix_are_those_of_pinocchio(name: str) -> None:
    robot = load_robot(name)
    world, random = world_of(robot), np.random.default_rng(3)
    assert float(world.model.body_mass.sum()) == pytest.approx(robot.mass, rel=1e-9)
    dofs = [*range(6), *world.velocities]
    order = [*range(6), *(robot.pin.joints[robot.pin.getJointId(n)].idx_v for n in robot.joint_names)]
    for _ in range(3):
        pose, q = random.uniform(-1, 1, 6), random.uniform(-1, 1, len(robot.joint_names))
        world.place_robot(pose, q)
        found = np.zeros((world.model.nv, world.model.nv))
        mujoco.mj_fullM(world.model, world.data, found)
        found -= np.diag(world.model.dof_armature)  # what makes the servos' damping implicit
        upper = np.triu(pinocchio.crba(robot.pin, robot.pin.createData(), robot.configuration(pose, q)))
        expected = (upper + np.triu(upper, 1).T)[np.ix_(order, order)]
        turn = np.eye(len(order))
        turn[:3, :3] = pinocchio.rpy.rpyToMatrix(pose[3:])  # Pinocchio's linear velocity is in the base's own axes
        np.testing.assert_allclose(found[np.ix_(dofs, dofs)], turn @ expected @ turn.T, atol=1e-12)


def test_every_link_is_where_the_model_has_it_and_twists_are_in_world_axes() -> None:
    robot = walker(3, urdf=urdf(3, LOPSIDED))
    world = world_of(robot)
    world.place_robot(BASE, posture(3))
    assert world.links[0] == "base_link"
    for link in world.links:
        R, origin = world.link_pose(link)
        np.testing.assert_allclose(np.column_stack([R, origin]), robot.link_pose(link, BASE, posture(3))[:3], atol=1e-9)
    random = np.random.default_rng(0)
    world.data.qvel[:6] = random.uniform(-1, 1, 6)
    before = world.data.qpos.copy()[None]
    moved = world.data.qpos.copy()
    mujoco.mj_integratePos(world.model, moved, world.data.qvel, 1e-6)
    (poses, twists), (later, _) = (world.base_states(x, world.data.qvel[None]) for x in (before, moved[None]))
    np.testing.assert_allclose(poses[0], BASE, atol=1e-9)
    np.testing.assert_allclose((later - poses)[0, :3] / 1e-6, twists[0, :3], atol=1e-6)
    turned = pinocchio.rpy.rpyToMatrix(later[0, 3:]) @ pinocchio.rpy.rpyToMatrix(poses[0, 3:]).T
    np.testing.assert_allclose(pinocchio.log3(turned) / 1e-6, twists[0, 3:], atol=1e-6)


def test_contacts_have_the_forces_that_mujoco_gives_for_them_and_carry_the_robot() -> None:
    robot = walker(3)
    world = world_of(robot)
    world.place_robot([0.0, 0.0, HEIGHT, 0.0, 0.0, 0.0], posture(3))
    for _ in range(200):
        world.data.ctrl[:] = posture(3)
        mujoco.mj_step(world.model, world.data)
    found = robot_contacts(world)
    assert found[:, 5].sum() == pytest.approx(robot.mass * 9.81, rel=1e-3)
    assert set(found[:, 1]) == {-1.0}
    for row in found:
        index = int(np.argmin(np.linalg.norm(world.data.contact.pos - row[2:5], axis=1)))
        force = np.zeros((6, 1))
        mujoco.mj_contactForce(world.model, world.data, index, force)
        frame = world.data.contact.frame[index].reshape(3, 3)
        sign = 1.0 if world.owner[world.data.contact.geom[index, 1]] == row[0] else -1.0
        assert row[5] == pytest.approx(force[0, 0])
        np.testing.assert_allclose(row[6:9], sign * (force[1, 0] * frame[1] + force[2, 0] * frame[2]), atol=1e-9)
        foot = next(limb.foot for limb in robot.limbs if limb.foot.link == world.links[int(row[0])])
        R, origin = world.link_pose(foot.link)
        assert np.linalg.norm(row[2:5] - origin - R @ foot.offset) == pytest.approx(foot.radius, abs=1e-6)


def slid(angle_deg: float, azimuth_deg: float, friction: float) -> float:
    """Path [m] in half a second of a block on a slope."""
    block = SceneObject("block", "box", (3.0, 0.0, 0.025), size=(0.4, 0.4, 0.05), mass=1.0)
    world = world_of(walker(2), block, friction=friction)
    a, z = np.radians([angle_deg, azimuth_deg])
    world.model.opt.gravity[:] = 9.81 * np.array([np.sin(a) * np.cos(z), np.sin(a) * np.sin(z), -np.cos(a)])
    world.place_robot([0.0, 0.0, 1.0, 0.0, 0.0, 0.0], posture(2))
    first = world.movable["block"]
    for _ in range(250):
        mujoco.mj_step(world.model, world.data)
    return float(np.hypot(world.data.qpos[first] - 3.0, world.data.qpos[first + 1]))


@pytest.mark.parametrize("azimuth_deg", [0.0, 20.0, 45.0])
@pytest.mark.parametrize("friction", [0.5, 1.0])
def test_friction_is_the_stated_cone_in_every_direction(azimuth_deg: float, friction: float) -> None:
    limit = float(np.degrees(np.arctan(friction)))
    assert slid(limit - 2.0, azimuth_deg, friction) < 3e-3
    assert slid(limit + 2.0, azimuth_deg, friction) > 1e-2


def test_slip_of_a_walk_hardly_depends_on_the_step() -> None:
    robot = walker(3)
    gait = tripod_plan(robot)
    timeline = timeline_of(robot, (stand_plan(robot, 0.5, joints=gait.joint_positions[:, 0]), 1), (gait, 1))
    slips = []
    for rate in (500.0, 2000.0):
        verdict = verify_timeline(robot, timeline, simulator=MujocoSimulator(rate_hz=rate))
        slips.append(next(c.value for c in verdict.checks if c.name == "slip" and c.segment == "gait"))
    assert abs(slips[1] - slips[0]) < 2.0  # [mm]; 20 when the contact solver does not see the servos' damping
    assert max(slips) < 5.0


def heavy_tail(joints: int) -> str:
    """URDF of small fixed links that bring a four-legged walker to this many joints."""
    inertia = (
        '<inertial><mass value="1e-3"/><inertia ixx="1e-6" iyy="1e-6" izz="1e-6" ixy="0" ixz="0" iyz="0"/></inertial>'
    )
    return "".join(
        f'<link name="x{k}">{inertia}</link><joint name="xj{k}" type="fixed"><parent link="base_link"/>'
        f'<child link="x{k}"/></joint>'
        for k in range(joints - 12)
    )


def test_a_robot_of_128_joints_which_pybullet_refuses_is_verified() -> None:
    robot = walker(2, urdf=urdf(2).replace("</robot>", heavy_tail(128) + "</robot>"))
    timeline = timeline_of(robot, (stand_plan(robot, 0.3), 1))
    assert verify_timeline(robot, timeline, simulator=MujocoSimulator()).passed
    with pytest.raises(SimulationError, match="verify=mujoco takes it"):
        verify_timeline(robot, timeline)


def test_a_link_without_inertia_weighs_nothing_whatever_its_shape() -> None:
    tail = (
        '<link name="tail"><collision><geometry><sphere radius="0.03"/></geometry></collision></link>'
        '<joint name="t" type="fixed"><parent link="base_link"/><child link="tail"/></joint>'
    )
    robot = walker(2, urdf=urdf(2).replace("</robot>", tail + "</robot>"))
    assert float(world_of(robot).model.body_mass.sum()) == pytest.approx(robot.mass, rel=1e-12)


def test_an_inertia_that_no_body_has_is_a_simulation_error() -> None:
    bad = urdf(2).replace('ixx="', 'ixx="9', 1)
    with pytest.raises(SimulationError, match="MuJoCo does not take the robot"):
        world_of(walker(2, urdf=bad))


def test_a_collada_mesh_is_as_large_as_its_file_says(tmp_path: Path) -> None:
    box = trimesh.creation.box((0.2, 0.1, 0.06))
    (tmp_path / "box.dae").write_bytes(box.export(file_type="dae"))
    mesh = (
        f'<link name="tail"><collision><geometry><mesh filename="{tmp_path}/box.dae" scale="2 1 1"/></geometry>'
        '</collision></link><joint name="t" type="fixed"><parent link="base_link"/><child link="tail"/></joint>'
    )
    world = world_of(walker(2, urdf=urdf(2).replace("</robot>", mesh + "</robot>")))
    (geom,) = np.flatnonzero(world.model.geom_type == mujoco.mjtGeom.mjGEOM_MESH)
    extent = 2.0 * np.sort(world.model.geom_aabb[geom][3:])  # a mesh's frame is turned to its principal axes
    np.testing.assert_allclose(extent, [0.06, 0.1, 0.4], atol=1e-6)


def test_a_joint_commanded_to_no_number_is_an_error_and_writes_no_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    robot = walker(2)
    plan = stand_plan(robot, 0.2)
    world = replace(robot, velocity=np.full(12, np.nan))
    with pytest.raises(SimulationError, match=r"at 0\.000 s: a joint was commanded to no number"):
        MujocoSimulator(settle_s=0.0).run(world, timeline_of(robot, (plan, 1)), Scene())
    assert list(tmp_path.iterdir()) == []
    assert capfd.readouterr() == ("", "")


def test_a_joint_in_the_air_goes_no_faster_than_its_module_can_but_for_what_its_load_adds() -> None:
    slow = replace(walker(3), velocity=np.full(18, 0.1))
    gait = tripod_plan(slow)
    stand = stand_plan(slow, 0.5, joints=gait.joint_positions[:, 0])
    trace = MujocoSimulator().run(slow, timeline_of(slow, (stand, 1), (gait, 1)), Scene())
    free = np.repeat(trace.feet[:, :, 2] > 1.2 * float(trace.feet[0, 0, 2]), 3, axis=1)  # (n, n_J) limb off the ground
    assert free.sum() > 500
    assert np.abs(trace.plan.joint_velocities[free]).max() > 0.3
    weight = 2.0 * 0.15 * 9.81 * 0.15  # [N m] of a thigh and a shin about a hip
    kv = 7.0 / 0.01 / 72.0  # [N m s/rad]
    assert np.quantile(np.abs(trace.joint_velocities[free]), 0.95) < 0.1 + weight / kv


def test_a_squeeze_is_the_effort_that_the_timeline_allows(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = walker(3)
    timeline = timeline_of(robot, (stand_plan(robot, 0.3), 1))
    strong = MujocoSimulator().run(robot, timeline, Scene())
    allowed = np.full(18, 0.35)

    def weak(*arguments: object) -> TimelineSamples:
        plan = planned_rows(*arguments)  # type: ignore[arg-type]
        return replace(plan, efforts=np.tile(allowed, (len(plan.times), 1)))

    monkeypatch.setattr("gaitforge.verify.mujoco.simulator.planned_rows", weak)
    squeezed = MujocoSimulator().run(robot, timeline, Scene())
    assert np.abs(strong.joint_torques).max() > 0.35
    assert np.abs(squeezed.joint_torques).max() == pytest.approx(0.35)


def test_a_robot_told_its_efforts_ahead_does_not_sag() -> None:
    robot = walker(3)
    timeline = timeline_of(robot, (stand_plan(robot, 0.3), 1))

    def sag(share: float) -> float:
        trace = MujocoSimulator(effort_feedforward=share).run(robot, timeline, Scene())
        return float(np.abs(trace.joint_positions[-1] - trace.plan.joint_positions[-1]).max())

    bare = sag(0.0)
    assert bare > 0.0005  # [rad]
    assert sag(0.5) == pytest.approx(0.5 * bare, rel=0.2)
    assert sag(1.0) < 0.15 * bare


def test_an_effort_ahead_is_no_more_than_the_module_gives(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = walker(3)
    timeline = timeline_of(robot, (stand_plan(robot, 0.1), 1))

    def much(*arguments: object) -> np.ndarray:
        return np.full((len(planned_rows(timeline, 500.0).times), 18), 50.0)

    monkeypatch.setattr("gaitforge.verify.mujoco.simulator.planned_efforts", much)
    trace = MujocoSimulator(settle_s=0.0).run(robot, timeline, Scene())
    assert np.abs(trace.joint_torques).max() == pytest.approx(7.0)


def box_between_palms(friction: float) -> float:
    """Path [m] in half a second, downwards, of a box of 0.5 kg that two of 1 kg press between them with 10 N."""
    held = SceneObject("held", "box", (3.0, 0.0, 2.0), size=(0.1, 0.1, 0.1), mass=0.5)
    palms = [SceneObject(n, "box", (3.0, y, 2.0), size=(0.1, 0.1, 0.1), mass=1.0) for n, y in (("a", 0.1), ("b", -0.1))]
    world = world_of(walker(2), held, *palms, friction=friction)
    world.place_robot([0.0, 0.0, 1.0, 0.0, 0.0, 0.0], posture(2))
    bodies = [int(world.model.jnt_bodyid[list(world.model.jnt_qposadr).index(world.movable[n])]) for n in ("a", "b")]
    for _ in range(250):
        for body, push in zip(bodies, (-10.0, 10.0), strict=True):
            world.data.xfrc_applied[body, :3] = [0.0, push, 1.25 * 9.81]  # its own weight and half the box's
        mujoco.mj_step(world.model, world.data)
    return float(2.0 - world.data.qpos[world.movable["held"] + 2])


def test_friction_holds_a_box_while_it_bears_its_weight_and_not_when_it_is_too_small() -> None:
    assert abs(box_between_palms(0.5)) < 0.005  # two contacts carry 2 · 0.5 · 10 N, the box weighs 4.9 N
    braked, free = 0.5 * (9.81 - 2 * 0.05 * 10.0 / 0.5) * 0.5**2, 0.5 * 9.81 * 0.5**2  # [m]; it leaves the palms
    assert braked < box_between_palms(0.05) < free


def test_a_pipe_is_hollow_and_its_wall_is_solid() -> None:
    pipe = SceneObject("pipe", "pipe", (1.0, 0.0, 0.3), (0.0, 0.0, 0.4), radius=0.1, length=0.5)
    world = world_of(walker(2), pipe)
    world.place_robot([-2.0, 0.0, 1.0, 0.0, 0.0, 0.0], posture(2))
    axis, left = np.array([np.cos(0.4), np.sin(0.4), 0.0]), np.array([-np.sin(0.4), np.cos(0.4), 0.0])
    opening = np.array(pipe.xyz)
    assert world.first_hit(opening - axis, opening + axis) is None
    assert world.first_hit(opening - axis + 0.097 * left, opening + axis + 0.097 * left) == 0
    assert world.first_hit(opening + 0.25 * axis + left, opening + 0.25 * axis) == 0
    assert world.first_hit(opening - 0.01 * axis + left, opening - 0.01 * axis) is None
    assert world.first_hit(opening, opening - np.array([0.0, 0.0, 1.0])) == 0
    assert world.first_hit(np.array([3.0, 3.0, 1.0]), np.array([3.0, 3.0, -1.0])) == -1


def test_neighbouring_links_may_overlap_and_others_may_not() -> None:
    robot = walker(2)
    world = world_of(robot)
    folded = posture(2).copy()
    folded[1:3] = [0.0, 3.1]  # the shin of L1 lies along its thigh, and its foot in the coxa, two links up
    world.place_robot([0.0, 0.0, 1.0, 0.0, 0.0, 0.0], folded)
    pairs = {tuple(sorted((world.links[int(a)], world.links[int(b)]))) for a, b in robot_contacts(world)[:, :2]}
    parents = {tuple(sorted((f"{limb.name}_femur", f"{limb.name}_tibia"))) for limb in robot.limbs}
    assert not pairs & parents
    assert ("L1_coxa", "L1_tibia") in pairs


@pytest.mark.parametrize(
    ("key", "value"),
    [("rate_hz", 0.0), ("full_effort_error", -1.0), ("friction", -0.1), ("iterations", 0), ("contact_time", 0.003)],
)
def test_settings_that_make_no_sense_are_refused_by_name(key: str, value: float) -> None:
    with pytest.raises(InputError, match=key):
        MujocoSimulator(**{key: value})


def test_the_config_file_names_every_setting_and_its_default() -> None:
    text = (Path(__file__).parents[2] / "conf" / "verify" / "mujoco.yaml").read_text()
    settings = yaml.safe_load(text)
    assert settings.pop("_target_") == "gaitforge.verify.mujoco.MujocoSimulator"
    default = asdict(MujocoSimulator())
    del default["name"]
    assert settings == default
    lines = [line for line in text.splitlines() if ":" in line and not line.startswith(("#", "_target_"))]
    assert all("#" in line for line in lines)


def test_a_verdict_of_mujoco_needs_no_pybullet() -> None:
    code = (
        "import sys; sys.modules['pybullet'] = None; sys.path.insert(0, sys.argv[1])\n"
        "from walkers import stand_plan, timeline_of, walker\n"
        "import gaitforge as gf\n"
        "robot = walker(2)\n"
        "print(gf.verify(robot, [(stand_plan(robot, 0.2), 1)], simulator='mujoco').passed)\n"
        "try:\n    gf.verify(robot, [(stand_plan(robot, 0.2), 1)], simulator='pybullet')\n"
        "except gf.errors.SimulationError as error:\n    print(error)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(Path(__file__).parent)], capture_output=True, text=True, check=True
    )
    said = done.stdout.splitlines()
    assert said[0] == "True"
    assert "verify=mujoco" in said[1]
