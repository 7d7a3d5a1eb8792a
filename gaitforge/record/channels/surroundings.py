"""`/viz/scene`: what stands around the robot, and where its tools look."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.timeline import Aim
from gaitforge.record.channels.channel import Channel, protobuf_channel
from gaitforge.record.channels.drawings import ball, entity, paint
from gaitforge.record.channels.transforms import set_pose
from gaitforge.record.run import Run
from gaitforge.record.tree import base_to_pose
from gaitforge.task.scene import SceneObject

Array = NDArray[np.float64]
STEEL, WOOD, SIGHT = (0.55, 0.6, 0.65), (0.75, 0.55, 0.35), (1.0, 0.75, 0.0)
SIDES = 32
"""Faces around a pipe."""


def surroundings_channels(run: Run) -> list[Channel]:
    """One update at the start, and one whenever a tool begins or ends to look at its target."""
    from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate

    aims = run.timeline.aims
    instants = sorted({0.0, *(a.start for a in aims), *(a.end for a in aims if a.end < run.timeline.duration)})
    fixed = [item for item in run.scene.objects if item.name not in run.trace.objects]
    messages = []
    for time in instants:
        update = SceneUpdate()
        for item in fixed:
            _draw(entity(update, item.name, run, time), item)
        for aim in aims:
            _sight(update, run, aim, time)
        messages.append((run.stamp(time), update))
    return [protobuf_channel("/viz/scene", SceneUpdate, messages)]


def tube(item: SceneObject) -> Array:
    """(3 k, 3) corners of the triangles of a pipe, in its frame: opening at the origin, axis +x, both ends open."""
    angle = np.linspace(0.0, 2.0 * np.pi, SIDES + 1)
    circle = np.stack([np.zeros_like(angle), np.cos(angle), np.sin(angle)], axis=1)
    along = np.array([item.length, 0.0, 0.0])
    outer, inner = item.radius * circle, (item.radius - item.thickness) * circle
    walls = ((outer, outer + along), (inner + along, inner), (inner, outer), (outer + along, inner + along))
    quads = [
        np.stack([a[:-1], b[:-1], b[1:], a[:-1], b[1:], a[1:]], axis=1).reshape(-1, 3)
        for a, b in walls  # both faces of every wall are seen: viewers do not cull
    ]
    return np.concatenate(quads)


def _draw(drawing: Any, item: SceneObject) -> None:
    pose = base_to_pose([*item.xyz, *item.rpy])[0]
    if item.kind == "pipe":
        mesh = drawing.triangles.add()
        set_pose(mesh.pose, pose)
        paint(mesh.color, STEEL, 0.85)
        for x, y, z in tube(item).tolist():
            mesh.points.add(x=x, y=y, z=z)
        return
    cube = drawing.cubes.add()
    set_pose(cube.pose, pose)
    cube.size.x, cube.size.y, cube.size.z = item.size
    paint(cube.color, WOOD)


def _sight(update: Any, run: Run, aim: Aim, time: float) -> None:
    """Target, and the optical axis in the tool's own frame: it moves with the tool until the aim ends."""
    from foxglove_schemas_protobuf.LinePrimitive_pb2 import LinePrimitive

    tool = next((t for t in run.robot.tools if t.name == aim.tool), None)
    target = entity(update, f"{aim.tool} target", run, time)
    axis = entity(update, f"{aim.tool} sight", run, time, tool.link if tool else "world", locked=True)
    if tool is None or not aim.start <= time < aim.end:
        return
    ball(target, np.asarray(aim.target), 0.04, SIGHT)
    at = int(np.argmin(np.abs(run.trace.times - aim.start)))
    plan = run.trace.plan
    origin = run.robot.link_pose(tool.link, plan.base_poses[at], plan.joint_positions[at]) @ tool.T_link_tool
    length = float(np.linalg.norm(np.asarray(aim.target) - origin[:3, 3]))
    line = axis.lines.add(type=LinePrimitive.LINE_STRIP, thickness=0.005)
    line.pose.orientation.w = 1.0
    paint(line.color, SIGHT, 0.8)
    for distance in (0.0, length):
        x, y, z = (tool.T_link_tool @ [0.0, 0.0, distance, 1.0])[:3].tolist()
        line.points.add(x=x, y=y, z=z)
