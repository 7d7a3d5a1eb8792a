"""What the simulator saw: one row per simulation step."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.timeline import TimelineSamples

Array = NDArray[np.float64]


@dataclass(frozen=True)
class UnplannedContact:
    """Something touched what it should not have."""

    time: float
    """[s]"""
    what: str
    """e.g. "R2 shin on ground", "L1 foot against L2 shin" """
    force: float
    """Largest normal force [N]"""
    end: float = 0.0
    """[s] of the last step of the event"""
    kind: Literal["trunk", "ground", "swing", "self", "object", "limp"] = "ground"
    """trunk or another link on the ground, a foot on it in swing, itself, an object, a limp limb (expected)"""


@dataclass(frozen=True, eq=False)
class Trace:
    """The simulated run; n rows at `times`, t = 0 is the start of the timeline (after settling)."""

    times: Array
    """(n,) [s]"""
    plan: TimelineSamples
    """What was planned at the same times."""
    base_poses: Array
    """(n, 6) measured pose of base_link in the world"""
    joint_positions: Array
    """(n, n_J) [rad]"""
    joint_velocities: Array
    """(n, n_J) [rad/s]"""
    joint_torques: Array
    """(n, n_J) [N m]"""
    normal_force: Array
    """(n, n_F) of each foot on the ground [N]"""
    friction_force: Array
    """(n, n_F, 3) tangential ground force on each foot, world [N]"""
    contact_points: Array
    """(n, n_F, 3) below each foot on the ground, world [m] (the last one known while in the air)"""
    slip_speed: Array
    """(n, n_F) tangential speed of the contact point, rolling taken out [m/s]; 0 in the air"""
    feet: Array
    """(n, n_F, 3) centres of the foot spheres, world [m]"""
    com: Array
    """(n, 3) measured centre of mass, world [m]"""
    margin: Array
    """(n,) static margin: distance of the CoM's projection inside the polygon of real contacts [m] (< 0 outside)"""
    pointing: dict[str, Array] = field(default_factory=dict)
    """tool name → (n,) angle between optical axis and target [rad], NaN when not aimed"""
    sight: dict[str, NDArray[np.bool_]] = field(default_factory=dict)
    """tool name → (n,) is the line of sight to the target free"""
    unplanned: tuple[UnplannedContact, ...] = ()
    images: tuple[tuple[float, bytes], ...] = ()
    """(time [s], PNG) of the camera at `camera_hz`, when asked for"""
    camera_fov_deg: float = 0.0
    """[deg] vertical opening angle of the camera that took `images`"""
    aim_feedback_hz: float = 0.0
    """[Hz] tool limbs were aimed again from the measured pose of the body; 0: open loop"""
    objects: dict[str, Array] = field(default_factory=dict)
    """name of a movable object of the scene → (n, 7) its pose in the world: x, y, z [m], quaternion x, y, z, w"""
    overlapping: tuple[tuple[str, str], ...] = ()
    """Links whose shapes overlap in the nominal posture, as many files draw them: their contacts are ignored"""
