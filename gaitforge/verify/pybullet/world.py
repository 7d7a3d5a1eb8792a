"""The simulated world: ground, robot and scene in a PyBullet client."""

from __future__ import annotations

import tempfile
import xml.etree.ElementTree as ET
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitforge.errors import SimulationError
from gaitforge.robot.gravity import GRAVITY
from gaitforge.robot.model import RobotModel
from gaitforge.robot.rotation import matrices, matrices_of_quaternions, poses_of, quaternions
from gaitforge.task.scene import Scene, SceneObject
from gaitforge.verify.pybullet.client import quiet
from gaitforge.verify.scene import boxes_of
from gaitforge.verify.sight import OTHER
from gaitforge.verify.welds import Weld

Array = NDArray[np.float64]
MAX_JOINTS = 127
"""A body with more joints (fixed ones count) loads and steps, but answers no state call."""
TORSION_M = 0.01
"""[m] torque about the normal of a contact with a movable object, per newton of normal force: what the patch of a
rubber tip some 15 mm across gives"""
STEEL, WOOD = (0.62, 0.65, 0.69, 1.0), (0.80, 0.58, 0.36, 1.0)
"""Colours of what stands fast and of what can be carried."""
ALOFT_M = 100.0
"""[m] height at which the robot touches nothing but itself"""
MASS_TOLERANCE = 1e-6
"""Relative"""


@dataclass(frozen=True, eq=False)
class World:
    """Bodies of a client by name, and the frames that PyBullet's base calls speak of."""

    p: Any
    client: int
    ground: int
    robot: int
    objects: tuple[int, ...]
    """Body of each object of the scene"""
    movable: dict[str, int]
    """name → body of those that are not fixed in the world"""
    joints: tuple[int, ...]
    """PyBullet's joint index, in the order of `RobotModel.joint_names`"""
    links: tuple[str, ...]
    """Link names, the base first: PyBullet's link k is links[k + 1]"""
    com_in_base: Array
    """(3,) centre of mass of base_link in its frame [m]: base pose calls speak of a frame there"""
    R_base_inertial: Array
    """(3, 3) orientation of that frame in base_link"""
    overlapping: tuple[tuple[str, str], ...] = ()
    """Links whose shapes overlap in the nominal posture: their contacts are ignored"""

    def place_robot(self, base_pose: ArrayLike, joints: ArrayLike) -> None:
        """Put base_link at a pose (6,) and the joints at positions (n_J,), at rest."""
        pose = np.asarray(base_pose, dtype=float)
        R = matrices(pose[3:])
        position = pose[:3] + R @ self.com_in_base
        turned = quaternion_of(R @ self.R_base_inertial)
        self.p.resetBasePositionAndOrientation(self.robot, position, turned, physicsClientId=self.client)
        self.p.resetBaseVelocity(self.robot, [0.0] * 3, [0.0] * 3, physicsClientId=self.client)
        for joint, angle in zip(self.joints, np.asarray(joints, dtype=float), strict=True):
            self.p.resetJointState(self.robot, joint, float(angle), 0.0, physicsClientId=self.client)

    def base_states(self, positions: Array, xyzw: Array, linear: Array, angular: Array) -> tuple[Array, Array]:
        """(n, 6) poses and (n, 6) twists of base_link, from what the base calls gave for the CoM frame."""
        R = matrices_of_quaternions(xyzw) @ self.R_base_inertial.T
        arm = R @ -self.com_in_base  # (n, 3) from the CoM to the origin of base_link, world axes
        poses = poses_of(positions + arm, R)
        return poses, np.concatenate([linear + np.cross(angular, arm), angular], axis=1)

    def first_hit(self, start: Array, end: Array) -> int | None:
        """See `gaitforge.verify.sight.World`."""
        body = self.p.rayTest(start.tolist(), end.tolist(), physicsClientId=self.client)[0][0]
        if body < 0:
            return None
        return self.objects.index(body) if body in self.objects else OTHER

    def fasten(self, weld: Weld) -> int:
        """See `gaitforge.verify.welds.World`.  A constraint speaks of centre-of-mass frames, those of an object too."""
        body, link = self.movable[weld.object], self.links.index(weld.link) - 1
        if link < 0:
            here = self.p.getBasePositionAndOrientation(self.robot, physicsClientId=self.client)
        else:
            here = self.p.getLinkState(self.robot, link, computeForwardKinematics=1, physicsClientId=self.client)[:2]
        there = self.p.getBasePositionAndOrientation(body, physicsClientId=self.client)
        position, turned = self.p.multiplyTransforms(*self.p.invertTransform(*here), *there)
        return int(
            self.p.createConstraint(
                self.robot, link, body, -1, self.p.JOINT_FIXED, [0.0] * 3, position, [0.0] * 3, turned,
                physicsClientId=self.client,
            )
        )  # fmt: skip

    def release(self, fastened: int) -> None:
        """See `gaitforge.verify.welds.World`."""
        self.p.removeConstraint(fastened, physicsClientId=self.client)

    def link_pose(self, link: str) -> tuple[Array, Array]:
        """Rotation (3, 3) and origin (3,) of a link's frame now."""
        index = self.links.index(link) - 1
        if index < 0:
            position, xyzw = self.p.getBasePositionAndOrientation(self.robot, physicsClientId=self.client)
            R = matrices_of_quaternions(xyzw) @ self.R_base_inertial.T
            return R, np.array(position) - R @ self.com_in_base
        state = self.p.getLinkState(self.robot, index, computeForwardKinematics=1, physicsClientId=self.client)
        return matrices_of_quaternions(state[5]), np.array(state[4])


def quaternion_of(R: Array) -> Array:
    """(4,) x, y, z, w of a rotation matrix (3, 3)."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_matrix(R).as_quat())


def build_world(p: Any, client: int, robot: RobotModel, scene: Scene, friction: float) -> World:
    """Ground, robot and scene; the friction coefficient of each pair with the robot is `friction`.

    PyBullet multiplies the coefficients of the two bodies: the robot has `friction`, all else 1.
    """
    p.setGravity(0.0, 0.0, -GRAVITY, physicsClientId=client)
    plane = p.createCollisionShape(p.GEOM_PLANE, physicsClientId=client)
    ground = p.createMultiBody(0, plane, physicsClientId=client)
    p.changeDynamics(ground, -1, lateralFriction=1.0, restitution=0.0, physicsClientId=client)
    body = _load_robot(p, client, robot)
    count = p.getNumJoints(body, physicsClientId=client)
    if count > MAX_JOINTS:
        known = f"PyBullet answers for at most {MAX_JOINTS} joints, found {count}"
        raise SimulationError(f"{robot.name}: {known}; verify=mujoco takes it")
    infos = [p.getJointInfo(body, i, physicsClientId=client) for i in range(count)]
    links = (p.getBodyInfo(body, physicsClientId=client)[0].decode(), *(info[12].decode() for info in infos))
    index = {info[1].decode(): i for i, info in enumerate(infos)}
    dynamics = p.getDynamicsInfo(body, -1, physicsClientId=client)
    objects = tuple(add_object(p, client, item) for item in scene.objects)
    world = World(
        p=p,
        client=client,
        ground=ground,
        robot=body,
        objects=objects,
        movable={item.name: body for item, body in zip(scene.objects, objects, strict=True) if item.movable},
        joints=tuple(index[name] for name in robot.joint_names),
        links=links,
        com_in_base=np.array(dynamics[3]),
        R_base_inertial=matrices_of_quaternions(dynamics[4]),
    )
    _check(world, robot)
    _prepare_robot(world, friction, [i for i, info in enumerate(infos) if info[2] != p.JOINT_FIXED])
    return replace(world, overlapping=_ignore_overlaps(world, robot))


def _load_robot(p: Any, client: int, robot: RobotModel) -> int:
    """PyBullet reads files only, and fails on a file of one long line."""
    flags = p.URDF_USE_INERTIA_FROM_FILE | p.URDF_USE_SELF_COLLISION
    with tempfile.TemporaryDirectory() as folder, quiet() as said:
        path = Path(folder) / "robot.urdf"
        tree = ET.ElementTree(ET.fromstring(robot.urdf))
        ET.indent(tree)
        tree.write(path)
        try:
            return int(p.loadURDF(str(path), flags=flags, physicsClientId=client))
        except p.error as error:
            said.seek(0)
            words = said.read().decode(errors="replace").strip().splitlines()
            reason = words[-1] if words else str(error)
            raise SimulationError(f"{robot.name}: PyBullet does not load the URDF: {reason}") from error


def _check(world: World, robot: RobotModel) -> None:
    """A URDF may be read differently by different readers; here is where that is noticed."""
    if world.links[0] != robot.base_link:
        raise SimulationError(f"{robot.name}: the root is {world.links[0]} in PyBullet, not {robot.base_link}")
    mass = sum(
        world.p.getDynamicsInfo(world.robot, i - 1, physicsClientId=world.client)[0] for i in range(len(world.links))
    )
    if abs(mass - robot.mass) > MASS_TOLERANCE * robot.mass:
        raise SimulationError(f"{robot.name}: {mass:.6g} kg in PyBullet, {robot.mass:.6g} kg in the model")


def _ignore_overlaps(world: World, robot: RobotModel) -> tuple[tuple[str, str], ...]:
    """Links that overlap in the nominal posture do not collide; many files draw thigh and trunk so."""
    p, client = world.p, world.client
    world.place_robot([0.0, 0.0, ALOFT_M, 0.0, 0.0, 0.0], robot.nominal.posture)
    p.performCollisionDetection(physicsClientId=client)
    found = p.getContactPoints(world.robot, world.robot, physicsClientId=client)
    pairs = sorted({(min(c[3], c[4]), max(c[3], c[4])) for c in found if c[8] < 0.0})
    for one, other in pairs:
        p.setCollisionFilterPair(world.robot, world.robot, one, other, 0, physicsClientId=client)
    return tuple((world.links[one + 1], world.links[other + 1]) for one, other in pairs)


def _prepare_robot(world: World, friction: float, movable: list[int]) -> None:
    """Friction and no damping on every link; no motor but those that are commanded."""
    p, client = world.p, world.client
    for link in range(-1, len(world.links) - 1):
        p.changeDynamics(
            world.robot,
            link,
            lateralFriction=friction,
            spinningFriction=0.0,
            rollingFriction=0.0,
            restitution=0.0,
            linearDamping=0.0,
            angularDamping=0.0,
            jointDamping=0.0,
            physicsClientId=client,
        )
    for joint in movable:  # a movable joint starts with a motor that holds it
        p.setJointMotorControl2(world.robot, joint, p.VELOCITY_CONTROL, force=0.0, physicsClientId=client)


def add_object(p: Any, client: int, item: SceneObject) -> int:
    """One body made of the object's boxes; mass 0 stands fast."""
    color = WOOD if item.movable else STEEL
    boxes = boxes_of(item)
    half = [[0.5 * s for s in box.size] for box in boxes]
    places = {
        "FramePositions": [box.xyz for box in boxes],
        "FrameOrientations": [quaternions(box.rpy).tolist() for box in boxes],
    }
    kinds = [p.GEOM_BOX] * len(boxes)
    shape = p.createCollisionShapeArray(
        shapeTypes=kinds,
        halfExtents=half,
        physicsClientId=client,
        **{f"collision{key}": value for key, value in places.items()},
    )
    visual = p.createVisualShapeArray(
        shapeTypes=kinds,
        halfExtents=half,
        rgbaColors=[list(color)] * len(boxes),
        physicsClientId=client,
        **{f"visual{key}": value for key, value in places.items()},
    )
    body = p.createMultiBody(item.mass, shape, visual, item.xyz, quaternions(item.rpy).tolist(), physicsClientId=client)
    # Bullet's spinning friction of a pair is the sum of each body's times the other's friction: only objects have some.
    spin = TORSION_M if item.movable else 0.0
    p.changeDynamics(
        body, -1, lateralFriction=1.0, spinningFriction=spin, restitution=0.0, linearDamping=0.0, angularDamping=0.0,
        physicsClientId=client,
    )  # fmt: skip
    return int(body)
