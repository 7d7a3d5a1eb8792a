"""Is the line from a camera to its target free: one ray a step."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitforge.motion.timeline import Aim, Timeline
from gaitforge.robot.limbs import ToolMount
from gaitforge.robot.model import RobotModel
from gaitforge.task.scene import Scene
from gaitforge.verify.pointing import aim_rows
from gaitforge.verify.scene import owner_of

Array = NDArray[np.float64]
OTHER = -1
"""What a ray hits when it is no object of the scene: the ground or the robot."""
SHORT_M = 0.005
"""A ray ends this far before its target [m], so that it does not touch what the target is a point of."""


class World(Protocol):
    """What a ray needs to know of a simulated world."""

    def link_pose(self, link: str) -> tuple[Array, Array]:
        """Rotation (3, 3) and origin (3,) of a link's frame now."""
        ...

    def first_hit(self, start: Array, end: Array) -> int | None:
        """Index of the scene's object that a ray between two points meets first, `OTHER` for anything else, or None."""
        ...


class SightLines:
    """Rays of a timeline's aims through a simulated world, written row by row."""

    def __init__(self, world: World, robot: RobotModel, timeline: Timeline, scene: Scene, times: Array) -> None:
        self._world = world
        tools = {tool.name: tool for tool in robot.tools}
        self._rays = [
            (aim, tools[aim.tool], clear_of_camera(robot, tools[aim.tool]), _target_box(scene, aim))
            for aim in timeline.aims
        ]
        self._active = [aim_rows(times, aim.start, aim.end) for aim in timeline.aims]
        self.free = {aim.tool: np.ones(len(times), dtype=bool) for aim in timeline.aims}

    def look(self, row: int) -> None:
        """Cast the rays of the aims that hold at this row."""
        for (aim, tool, start, target), active in zip(self._rays, self._active, strict=True):
            if active[row]:
                self.free[aim.tool][row] = self._is_free(aim, tool, start, target)

    def _is_free(self, aim: Aim, tool: ToolMount, start: float, target: int | None) -> bool:
        R, origin = self._world.link_pose(tool.link)
        eye = origin + R @ tool.T_link_tool[:3, 3]
        way = aim.target - eye
        length = float(np.linalg.norm(way))
        if length <= start + SHORT_M:
            return True
        way /= length
        hit = self._world.first_hit(eye + start * way, eye + (length - SHORT_M) * way)
        return hit is None or hit == target


def clear_of_camera(robot: RobotModel, tool: ToolMount) -> float:
    """Distance [m] ahead of the optical centre at which a ray is outside the shapes that hold the centre."""
    eye, axis = tool.T_link_tool[:3, 3], tool.T_link_tool[:3, 2]
    ahead = np.arange(0.0, 0.3, 0.001)
    inside = np.zeros(len(ahead), dtype=bool)
    for capsule in robot.capsules:
        if capsule.link == tool.link and _in_capsule(eye[None], capsule.a, capsule.b, capsule.radius)[0]:
            inside |= _in_capsule(eye + ahead[:, None] * axis, capsule.a, capsule.b, capsule.radius)
    return float(ahead[inside].max(initial=0.0)) + SHORT_M


def _in_capsule(points: Array, a: ArrayLike, b: ArrayLike, radius: float) -> NDArray[np.bool_]:
    start, along = np.asarray(a, dtype=float), np.asarray(b, dtype=float) - np.asarray(a, dtype=float)
    share = np.clip((points - start) @ along / max(float(along @ along), 1e-12), 0.0, 1.0)
    return np.asarray(np.linalg.norm(points - start - share[:, None] * along, axis=1) <= radius)


def _target_box(scene: Scene, aim: Aim) -> int | None:
    """The object whose near side is what the camera is to see: a box looked at in its centre, never a pipe's wall."""
    item = owner_of(scene, aim.target)
    return scene.objects.index(item) if item is not None and item.kind == "box" else None
