"""Preallocated arrays that the loop writes into, and the `Recording` made of them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitforge.verify.mujoco.world import World
from gaitforge.verify.recording import ContactTable, Recording

Array = NDArray[np.float64]


class Recorder:
    """n rows of a run; a state has one row more, so that the last row too has a velocity it moves on with."""

    def __init__(self, world: World, rows: int) -> None:
        self._world, self._rows = world, rows
        self._qpos = np.zeros((rows + 1, world.model.nq))
        self._qvel = np.zeros((rows + 1, world.model.nv))
        self._torque = np.zeros((rows, len(world.velocities)))
        self._contacts: list[Array] = []

    def state(self, row: int) -> None:
        """Write the state that the world is in now."""
        self._qpos[row], self._qvel[row] = self._world.data.qpos, self._world.data.qvel

    def step(self, row: int) -> None:
        """Write the forces of the step just made from the state of `row`."""
        self._torque[row] = self._world.data.qfrc_actuator[self._world.velocities]
        found = robot_contacts(self._world)
        if len(found):
            self._contacts.append(np.column_stack([np.full(len(found), float(row)), found]))

    def recording(self, times: Array, sight: dict[str, NDArray[np.bool_]], images: Any = ()) -> Recording:
        """Everything written so far, in the conventions of `Recording`."""
        world, rows = self._world, self._rows
        poses, twists = world.base_states(self._qpos, self._qvel)
        positions, velocities = self._qpos[:, world.positions], self._qvel[:, world.velocities]
        return Recording(
            times=times,
            links=world.links,
            base_poses=poses[:rows],
            base_twists=twists[:rows],
            joint_positions=positions[:rows],
            joint_velocities=velocities[:rows],
            joint_torques=self._torque,
            step_base_twists=twists[1:],
            step_joint_velocities=velocities[1:],
            contacts=_table(np.concatenate([np.zeros((0, 10)), *self._contacts])),
            sight=sight,
            images=tuple(images),
            objects={
                name: self._qpos[:rows, [first + k for k in (0, 1, 2, 4, 5, 6, 3)]]
                for name, first in world.movable.items()
            },
            overlapping=world.overlapping,
        )


def robot_contacts(world: World) -> Array:
    """(k, 9) contacts of the robot that bear load: link, other, point (3) on the link's surface, force, friction (3).

    A contact's forces are the first rows of its block of constraint forces (elliptic cone), in a frame
    whose x axis points from the first shape to the second; they act on the second.
    """
    data = world.data
    if not data.ncon:
        return np.zeros((0, 9))
    contact = data.contact
    owner, address = world.owner[contact.geom], np.asarray(contact.efc_address)
    forces = np.asarray(data.efc_force)
    on_robot = (owner >= 0) & (owner < len(world.links))
    normal = np.where(address >= 0, forces[np.maximum(address, 0)], 0.0)
    rows = np.flatnonzero(on_robot.any(axis=1) & (normal > 0.0))
    if not len(rows):
        return np.zeros((0, 9))
    address, frame = address[rows], np.asarray(contact.frame)[rows].reshape(-1, 3, 3)
    first = on_robot[rows, 0]  # the link is the first shape: forces turn round
    sign = np.where(first, -1.0, 1.0)[:, None]
    link, other = np.where(first[:, None], owner[rows], owner[rows, ::-1]).T
    friction = sign * (forces[address + 1, None] * frame[:, 1] + forces[address + 2, None] * frame[:, 2])
    # The contact's own point is half-way between the two surfaces.
    point = np.asarray(contact.pos)[rows] + 0.5 * sign * np.asarray(contact.dist)[rows, None] * frame[:, 0]
    return np.column_stack([link, other, point, normal[rows], friction])


def _table(data: Array) -> ContactTable:
    step, link, other = (data[:, k].astype(np.intp) for k in range(3))
    return ContactTable(step, link, other, data[:, 3:6], data[:, 6], data[:, 7:10])
