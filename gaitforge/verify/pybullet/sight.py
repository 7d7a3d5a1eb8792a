"""Is the line from a camera to its target free: one ray a step."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitforge.motion.timeline import Aim, Timeline
from gaitforge.robot.limbs import ToolMount
from gaitforge.robot.model import RobotModel
from gaitforge.task.scene import Scene
from gaitforge.verify.pointing import aim_rows
from gaitforge.verify.pybullet.world import World
from gaitforge.verify.scene import owner_of

Array = NDArray[np.float64]
SHORT_M = 0.005
"""A ray ends this far before its target [m], so that it does not touch what the target is a point of."""


class SightLines:
    """Rays of a timeline's aims through a PyBullet world, written row by row."""

    def __init__(self, world: World, robot: RobotModel, timeline: Timeline, scene: Scene, times: Array) -> None:
        self._world = world
        tools = {tool.name: tool for tool in robot.tools}
        self._rays = [
            (aim, tools[aim.tool], clear_of_camera(robot, tools[aim.tool]), _body_of_target(world, scene, aim))
            for aim in timeline.aims
        ]
        self._active = [aim_rows(times, aim.start, aim.end) for aim in timeline.aims]
        self.free = {aim.tool: np.ones(len(times), dtype=bool) for aim in timeline.aims}

    def look(self, row: int) -> None:
        """Cast the rays of the aims that hold at this row."""
        for (aim, tool, start, body), active in zip(self._rays, self._active, strict=True):
            if active[row]:
                self.free[aim.tool][row] = self._is_free(aim, tool, start, body)

    def _is_free(self, aim: Aim, tool: ToolMount, start: float, body: int) -> bool:
        world = self._world
        R, origin = world.link_pose(tool.link)
        eye = origin + R @ tool.T_link_tool[:3, 3]
        way = aim.target - eye
        length = float(np.linalg.norm(way))
        if length <= start + SHORT_M:
            return True
        way /= length
        ends = (eye + start * way).tolist(), (eye + (length - SHORT_M) * way).tolist()
        hit = world.p.rayTest(*ends, physicsClientId=world.client)[0][0]
        return bool(hit < 0 or hit == body)


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


def _body_of_target(world: World, scene: Scene, aim: Aim) -> int:
    """The body whose near side is what the camera is to see: a box looked at in its centre, never a pipe's wall."""
    item = owner_of(scene, aim.target)
    if item is None or item.kind != "box":
        return -1
    return world.objects[scene.objects.index(item)]
