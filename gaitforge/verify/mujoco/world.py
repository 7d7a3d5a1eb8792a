"""The simulated world: ground, robot and scene as one MuJoCo model and its state."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitforge.robot.model import RobotModel
from gaitforge.robot.rotation import matrices_of_quaternions, poses_of, quaternions
from gaitforge.task.scene import Scene
from gaitforge.verify.mujoco.build import Parts, build_model
from gaitforge.verify.mujoco.settings import Physics
from gaitforge.verify.sight import OTHER
from gaitforge.verify.welds import Weld

Array = NDArray[np.float64]
Rows = NDArray[np.intp]
LEAVE = 1e-9
"""Share of a ray by which it goes on behind the surface of a shape that it left."""


@dataclass(frozen=True, eq=False)
class World:
    """A model with its state, and where the robot and the scene are in it."""

    mj: Any
    """The mujoco module"""
    model: Any
    data: Any
    links: tuple[str, ...]
    """Link names, the base first"""
    bodies: Rows
    """(links,) MuJoCo's body of each"""
    owner: Rows
    """(geoms,) index of the link, GROUND, or len(links) + index of the scene's object"""
    positions: Rows
    """(n_J,) rows of qpos, in the order of `RobotModel.joint_names`"""
    velocities: Rows
    """(n_J,) rows of qvel and of joint torques"""
    movable: dict[str, int]
    """name → first row of qpos (x, y, z, quaternion w, x, y, z) of objects that are not fixed in the world"""
    overlapping: tuple[tuple[str, str], ...] = ()
    """Links whose shapes overlap in the nominal posture: their contacts are ignored"""
    welds: tuple[Weld, ...] = ()
    """The model's equalities"""

    def place_robot(self, base_pose: ArrayLike, joints: ArrayLike) -> None:
        """Put base_link at a pose (6,) and the joints at positions (n_J,), at rest."""
        pose = np.asarray(base_pose, dtype=float)
        self.data.qpos[:3] = pose[:3]
        self.data.qpos[3:7] = quaternions(pose[None, 3:])[0][[3, 0, 1, 2]]
        self.data.qpos[self.positions] = joints
        self.data.qvel[:] = 0.0
        self.mj.mj_forward(self.model, self.data)

    def base_states(self, qpos: Array, qvel: Array) -> tuple[Array, Array]:
        """(n, 6) poses and twists of base_link; a free joint's rates are linear in world and angular in own axes."""
        R = matrices_of_quaternions(qpos[:, [4, 5, 6, 3]])
        angular = np.einsum("nij,nj->ni", R, qvel[:, 3:6])
        return poses_of(qpos[:, :3], R), np.concatenate([qvel[:, :3], angular], axis=1)

    def fasten(self, weld: Weld) -> int:
        """See `gaitforge.verify.welds.World`.  The pose of the second body in the first one is what a weld keeps."""
        index = self.welds.index(weld)
        first, second = self.model.eq_obj1id[index], self.model.eq_obj2id[index]
        R, origin = np.array(self.data.xmat[first]).reshape(3, 3), self.data.xpos[first]
        back, turned = np.zeros(4), np.zeros(4)
        self.mj.mju_negQuat(back, self.data.xquat[first])
        self.mj.mju_mulQuat(turned, back, self.data.xquat[second])
        place = R.T @ (self.data.xpos[second] - origin)
        self.model.eq_data[index, :10] = np.concatenate([np.zeros(3), place, turned])
        self.data.eq_active[index] = 1
        return index

    def release(self, fastened: int) -> None:
        """See `gaitforge.verify.welds.World`."""
        self.data.eq_active[fastened] = 0

    def link_pose(self, link: str) -> tuple[Array, Array]:
        """Rotation (3, 3) and origin (3,) of a link's frame as of the last kinematics."""
        body = self.bodies[self.links.index(link)]
        return np.array(self.data.xmat[body]).reshape(3, 3), np.array(self.data.xpos[body])

    def first_hit(self, start: Array, end: Array) -> int | None:
        """See `gaitforge.verify.sight.World`.  A shape that the ray starts in is not met: it is left first."""
        geom, normal = np.full((1, 1), -1, dtype=np.int32), np.zeros((3, 1))
        while True:
            way = end - start
            share = self.mj.mj_ray(self.model, self.data, start, way, None, True, -1, geom, normal)
            if share < 0.0 or share > 1.0:
                return None
            if float(way @ normal[:, 0]) < 0.0:
                break
            start = start + (share + LEAVE) * way
        owner = int(self.owner[geom[0, 0]])
        return owner - len(self.links) if owner >= len(self.links) else OTHER


def build_world(robot: RobotModel, scene: Scene, physics: Physics, welds: Sequence[Weld] = ()) -> World:
    """Ground, robot and scene; SimulationError when MuJoCo refuses the robot."""
    import mujoco

    model, parts = build_model(mujoco, robot, scene, physics, welds)
    joints = [model.joint(name) for name in robot.joint_names]
    return World(
        mj=mujoco,
        model=model,
        data=mujoco.MjData(model),
        links=parts.links,
        bodies=np.array(parts.bodies, dtype=np.intp),
        owner=_owners(model, parts),
        positions=np.array([int(j.qposadr[0]) for j in joints], dtype=np.intp),
        velocities=np.array([int(j.dofadr[0]) for j in joints], dtype=np.intp),
        movable={
            item.name: int(model.jnt_qposadr[model.body_jntadr[body]])
            for item, body in zip(scene.objects, parts.objects, strict=True)
            if item.movable
        },
        overlapping=parts.overlapping,
        welds=tuple(welds),
    )


def _owners(model: Any, parts: Parts) -> Rows:
    """(geoms,) what each geom belongs to; the world's own geom is the ground, -1."""
    owner = np.full(model.nbody, -1, dtype=np.intp)
    owner[list(parts.bodies)] = np.arange(len(parts.bodies))
    owner[list(parts.objects)] = len(parts.bodies) + np.arange(len(parts.objects))
    return np.asarray(owner[model.geom_bodyid])
