"""What a simulator hands over: states and contacts, nothing derived.

Every simulator fills a `Recording`; `gaitforge.verify.assemble` turns it into a `Trace`, so that
contacts, slip, margins and pointing mean the same in all of them.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
GROUND = -1


@dataclass(frozen=True, eq=False)
class ContactTable:
    """Every contact point of the robot with a normal force, one row each, in the order of time."""

    step: NDArray[np.intp]
    """(k,) row of the recording: found in the state of that row, force held until the next one"""
    link: NDArray[np.intp]
    """(k,) index into `Recording.links`"""
    other: NDArray[np.intp]
    """(k,) GROUND, or an index into links (the robot itself), or len(links) + index into the scene's objects"""
    point: Array
    """(k, 3) on the link's surface, world [m]"""
    force: Array
    """(k,) normal force [N]"""
    friction: Array
    """(k, 3) tangential force on the link, world [N]"""


@dataclass(frozen=True, eq=False)
class Recording:
    """n states of the robot, dt apart; row 0 is the start of the timeline (after settling)."""

    times: Array
    """(n,) [s]"""
    links: tuple[str, ...]
    """Link names, the base first"""
    base_poses: Array
    """(n, 6) of base_link in the world [m, rad]"""
    base_twists: Array
    """(n, 6) linear velocity of base_link's origin and angular velocity, world axes [m/s, rad/s]"""
    joint_positions: Array
    """(n, n_J) [rad]"""
    joint_velocities: Array
    """(n, n_J) [rad/s]"""
    joint_torques: Array
    """(n, n_J) applied from this row to the next [N m]"""
    step_base_twists: Array
    """(n, 6) like base_twists, but the velocity with which the state moves on from this row to the next"""
    step_joint_velocities: Array
    """(n, n_J) the same for the joints"""
    contacts: ContactTable
    sight: dict[str, NDArray[np.bool_]] = field(default_factory=dict)
    """tool name → (n,) is the line of sight to its target free (True when it has none)"""
    images: tuple[tuple[float, bytes], ...] = ()
    camera_fov_deg: float = 0.0
    """[deg] vertical opening angle of the camera that took the pictures"""
    aim_feedback_hz: float = 0.0
    """[Hz] tool limbs were aimed again from the measured pose of the body; 0: as planned"""
    objects: dict[str, Array] = field(default_factory=dict)
    """name of a movable object of the scene → (n, 7) its pose in the world: x, y, z [m], quaternion x, y, z, w"""
    overlapping: tuple[tuple[str, str], ...] = ()
    """Links whose shapes overlap where the robot stands by its nominal posture: their contacts are ignored"""
