"""`recorded_poses`: where robot and loads were in a run, from its log alone: to draw it again without a simulation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitforge.errors import InputError, Problem
from gaitforge.record.reader import RunLog
from gaitforge.robot.rotation import matrices_of_quaternions, poses_of

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class RecordedPoses:
    """The simulated run at the log's rate; `gaitforge.verify.pictures` and `clips` draw it."""

    times: Array
    """(n,) [s]"""
    base_poses: Array
    """(n, 6) of base_link in the world [m, rad]"""
    joint_positions: Array
    """(n, n_J) [rad], columns as in `RobotModel.joint_names`"""
    feet: Array
    """(n, n_F, 3) centres of the foot spheres in the world [m]"""
    objects: dict[str, Array]
    """Name of what can be moved → (n, 7) position [m] and quaternion x, y, z, w in the world, of the last drawing"""


def recorded_poses(log: RunLog) -> RecordedPoses:
    """The topics ``/sim/base``, ``/sim/joint_states`` and ``/viz/loads`` of a log.

    Raises `InputError` when the log has none of the loads that its scene speaks of.
    """
    base = [(time, _pose(message.pose)) for time, message in log.messages("/sim/base")]
    times, places = np.array([time for time, _ in base]), np.array([pose for _, pose in base])
    poses = poses_of(places[:, :3], matrices_of_quaternions(places[:, 3:]))
    joints = np.array([[j.position for j in m.joints] for _, m in log.messages("/sim/joint_states")])
    feet = np.array([log.robot.foot_positions(pose, q) for pose, q in zip(poses, joints, strict=True)])
    return RecordedPoses(times, poses, joints, feet, _objects(log, times))


def _objects(log: RunLog, times: Array) -> dict[str, Array]:
    movable = [item.name for item in log.scene.objects if item.movable]
    if not movable:
        return {}
    stamps, drawn = [], []
    for time, update in log.messages("/viz/loads"):
        cubes = {entity.id: entity.cubes[0] for entity in update.entities if entity.cubes}
        stamps.append(time)
        drawn.append([_pose(cubes[name].pose) for name in movable])
    if not stamps:
        raise InputError(Problem(str(log.path), "/viz/loads", "no message", "the places of " + ", ".join(movable)))
    rows = np.clip(np.searchsorted(np.array(stamps), times + 1e-9, side="right") - 1, 0, None)
    found = np.array(drawn)[rows]
    return {name: found[:, k] for k, name in enumerate(movable)}


def _pose(message: Any) -> list[float]:
    p, q = message.position, message.orientation
    return [p.x, p.y, p.z, q.x, q.y, q.z, q.w]
