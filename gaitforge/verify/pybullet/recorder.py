"""Preallocated arrays that the loop writes into, and the `Recording` made of them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitforge.verify.pybullet.world import World
from gaitforge.verify.recording import GROUND, ContactTable, Recording

Array = NDArray[np.float64]


class Recorder:
    """n rows of a run; a state has one row more, so that the last row too has a velocity it moves on with."""

    def __init__(self, world: World, rows: int) -> None:
        self._world = world
        self._rows = rows
        self._base = np.zeros((rows + 1, 13))  # position, quaternion, linear, angular of the CoM frame
        self._joints = np.zeros((3, rows + 1, len(world.joints)))  # position, velocity, torque
        self._others = {world.ground: GROUND, **{body: k for k, body in enumerate(world.objects, len(world.links))}}
        self._movable = dict(world.movable)
        self._objects = np.zeros((rows, len(self._movable), 7))  # position, quaternion
        self._contacts: list[tuple[float, ...]] = []

    def state(self, row: int) -> None:
        """Write the state that the world is in now; the torque that led to it belongs to the row before."""
        p, world = self._world.p, self._world
        base = self._base[row]
        base[0:3], base[3:7] = p.getBasePositionAndOrientation(world.robot, physicsClientId=world.client)
        base[7:10], base[10:13] = p.getBaseVelocity(world.robot, physicsClientId=world.client)
        states = p.getJointStates(world.robot, world.joints, physicsClientId=world.client)
        self._joints[0, row] = [s[0] for s in states]
        self._joints[1, row] = [s[1] for s in states]
        self._joints[2, row - 1] = [s[3] for s in states]
        if row < self._rows:
            for k, body in enumerate(self._movable.values()):
                pose = p.getBasePositionAndOrientation(body, physicsClientId=world.client)
                self._objects[row, k, :3], self._objects[row, k, 3:] = pose

    def contacts(self, row: int) -> None:
        """Write the contacts of the step just made: found in the state of `row`, their force led away from it."""
        world, robot = self._world, self._world.robot
        for c in world.p.getContactPoints(bodyA=robot, physicsClientId=world.client):
            if c[9] <= 0.0:
                continue
            other = c[4] + 1 if c[2] == robot else self._others[c[2]]
            d1, d2, f1, f2 = c[11], c[13], c[10], c[12]
            friction = (f1 * d1[0] + f2 * d2[0], f1 * d1[1] + f2 * d2[1], f1 * d1[2] + f2 * d2[2])
            self._contacts.append((row, c[3] + 1, other, *c[5], c[9], *friction))

    def recording(self, times: Array, sight: dict[str, NDArray[np.bool_]], images: Any) -> Recording:
        """Everything written so far, in the conventions of `Recording`."""
        base, joints, rows = self._base, self._joints, self._rows
        poses, twists = self._world.base_states(base[:, :3], base[:, 3:7], base[:, 7:10], base[:, 10:13])
        return Recording(
            times=times,
            links=self._world.links,
            base_poses=poses[:rows],
            base_twists=twists[:rows],
            joint_positions=joints[0, :rows],
            joint_velocities=joints[1, :rows],
            joint_torques=joints[2, :rows],
            step_base_twists=twists[1:],
            step_joint_velocities=joints[1, 1:],
            contacts=_table(self._contacts),
            sight=sight,
            images=tuple(images),
            objects={name: self._objects[:, k] for k, name in enumerate(self._movable)},
            overlapping=self._world.overlapping,
        )


def _table(rows: list[tuple[float, ...]]) -> ContactTable:
    data = np.array(rows, dtype=float).reshape(-1, 10)
    step, link, other = (data[:, k].astype(np.intp) for k in range(3))
    return ContactTable(step, link, other, data[:, 3:6], data[:, 6], data[:, 7:10])
