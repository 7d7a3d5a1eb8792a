"""`/viz/loads`: objects that can be moved, where they are and where a grasp is to have them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitforge.record.channels.channel import Channel, protobuf_channel
from gaitforge.record.channels.drawings import entity, paint
from gaitforge.record.channels.transforms import set_pose
from gaitforge.record.run import Run
from gaitforge.record.tree import base_to_pose
from gaitforge.robot.rotation import matrices, poses_of
from gaitforge.task.scene import SceneObject

Array = NDArray[np.float64]
CARDBOARD, GHOST = (0.80, 0.58, 0.30), 0.3


def load_channels(run: Run) -> list[Channel]:
    """One update at each of the scene's stamps; no channel where nothing can be moved."""
    from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate

    movable = [item for item in run.scene.objects if item.name in run.trace.objects]
    if not movable:
        return []
    rows, messages = run.scene_rows, []
    planned = {name: planned_places(run, poses, rows) for name, poses in run.trace.plan.loads.items()}
    for k, row in enumerate(rows.tolist()):
        update, time = SceneUpdate(), float(run.trace.times[row])
        for item in movable:
            _cube(entity(update, item.name, run, time), item, run.trace.objects[item.name][row], 1.0)
            ghost = entity(update, f"{item.name} planned", run, time)
            if item.name in planned and np.isfinite(planned[item.name][k]).all():
                _cube(ghost, item, planned[item.name][k], GHOST)
        messages.append((run.stamp(time), update))
    return [protobuf_channel("/viz/loads", SceneUpdate, messages)]


def planned_places(run: Run, poses: Array, rows: NDArray[np.intp]) -> Array:
    """(k, 7) position and quaternion in the world at rows (k,) of a load planned at `poses` (n, 6) in base_link."""
    base, load = run.trace.plan.base_poses[rows], poses[rows]
    R = matrices(base[:, 3:])
    places = base[:, :3] + np.einsum("nij,nj->ni", R, load[:, :3])
    return base_to_pose(poses_of(places, R @ matrices(load[:, 3:])))


def _cube(drawing: Any, item: SceneObject, pose: Array, alpha: float) -> None:
    cube = drawing.cubes.add()
    set_pose(cube.pose, pose)
    cube.size.x, cube.size.y, cube.size.z = item.size
    paint(cube.color, CARDBOARD, alpha)
