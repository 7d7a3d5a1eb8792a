"""Which contacts are feet on the ground, and what the feet feel there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitforge.robot.model import RobotModel
from gaitforge.verify.recording import GROUND, ContactTable

Array = NDArray[np.float64]
CONTACT_N = 1.0
"""Contact means a normal force above this [N]."""
SPHERE_M = 0.003
"""A contact point is on the foot when it is this close to the surface of the foot sphere [m]."""


@dataclass(frozen=True, eq=False)
class FootContacts:
    """Ground contact of the feet, n rows."""

    normal_force: Array
    """(n, n_F) [N]"""
    friction_force: Array
    """(n, n_F, 3) [N]"""
    contact: NDArray[np.bool_]
    """(n, n_F) normal force above CONTACT_N"""


def foot_of_contacts(
    robot: RobotModel, table: ContactTable, feet: Array, link_names: tuple[str, ...], link: NDArray[np.intp]
) -> NDArray[np.intp]:
    """(k,) index of the limb whose foot sphere each contact point lies on, -1 when on none.

    `link` (k,) says which of the robot's links is asked for (in a self-contact there are two);
    a contact on the foot's link but away from its sphere is the shin's, not the foot's.
    """
    found = np.full(len(link), -1, dtype=np.intp)
    for index, limb in enumerate(robot.limbs):
        rows = np.flatnonzero(link == link_names.index(limb.foot.link))
        reach = np.linalg.norm(table.point[rows] - feet[table.step[rows], index], axis=1)
        found[rows[np.abs(reach - limb.foot.radius) <= SPHERE_M]] = index
    return found


def foot_contacts(table: ContactTable, foot: NDArray[np.intp], steps: int, feet: int) -> FootContacts:
    """Forces of the ground on the feet; `foot` (k,) as `foot_of_contacts` gives it."""
    rows = np.flatnonzero((table.other == GROUND) & (foot >= 0))
    where = (table.step[rows], foot[rows])
    normal, friction = np.zeros((steps, feet)), np.zeros((steps, feet, 3))
    np.add.at(normal, where, table.force[rows])
    np.add.at(friction, where, table.friction[rows])
    return FootContacts(normal, friction, normal > CONTACT_N)


def last_contact_points(feet: Array, radii: Array, contact: NDArray[np.bool_]) -> Array:
    """(n, n_F, 3) the point below each foot on the ground, the last one known while it is in the air."""
    rows = np.arange(len(contact))[:, None]
    last = np.maximum.accumulate(np.where(contact, rows, -1), axis=0)
    last = np.where(last < 0, rows, last)
    points = feet[last, np.arange(contact.shape[1])[None, :]]
    return np.asarray(points - np.array([0.0, 0.0, 1.0]) * radii[None, :, None])
