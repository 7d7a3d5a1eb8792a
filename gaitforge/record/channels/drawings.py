"""`/viz/support`, `/viz/forces`, `/viz/footholds`: support polygon, forces and the planned steps in 3D."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitforge.record.channels.channel import Channel, Messages, protobuf_channel, set_stamp
from gaitforge.record.channels.transforms import WORLD
from gaitforge.record.derived import center_of_pressure
from gaitforge.record.run import Run
from gaitforge.record.tree import rotate
from gaitforge.robot.gravity import GRAVITY

Array = NDArray[np.float64]
LIFT_M = 0.002
"""[m] drawings lie this far above the ground, or the two flicker through each other."""
ARROW_M = 0.4
"""[m] length of an arrow that stands for the robot's weight."""

MAGENTA, BLUE, ORANGE, RED, GREEN = (
    (0.9, 0.1, 0.8),
    (0.1, 0.3, 0.9),
    (1.0, 0.55, 0.0),
    (0.85, 0.1, 0.1),
    (0.2, 0.7, 0.4),
)


def drawing_channels(run: Run) -> list[Channel]:
    """Scene updates, each with the full state: a viewer that seeks sees what it would have seen."""
    from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate

    return [
        protobuf_channel("/viz/support", SceneUpdate, _support(run)),
        protobuf_channel("/viz/forces", SceneUpdate, _forces(run)),
        protobuf_channel("/viz/footholds", SceneUpdate, _footholds(run)),
    ]


def hull(points: Array) -> Array:
    """(k, 2) corners of the convex hull of (n, 2) points, counter-clockwise (monotone chain)."""
    ordered = sorted(set(map(tuple, points.tolist())))
    if len(ordered) < 3:
        return np.array(ordered).reshape(-1, 2)
    halves: list[tuple[float, float]] = []
    for sequence in (ordered, ordered[::-1]):
        chain: list[tuple[float, float]] = []
        for x, y in sequence:
            while len(chain) > 1 and _turn(chain[-2], chain[-1], (x, y)) <= 0.0:
                chain.pop()
            chain.append((x, y))
        halves += chain[:-1]
    return np.array(halves)


def planned_footholds(run: Run) -> list[tuple[int, Array]]:
    """(limb row, (3,) point on the ground [m], world) of every stance that is planned, in time order."""
    plan, tree = run.trace.plan, run.tree
    stances = []
    for foot in range(plan.contact.shape[1]):
        down = np.flatnonzero(np.diff(plan.contact[:, foot].astype(int), prepend=0, append=0)).reshape(-1, 2)
        stances += [(int((a + b) // 2), foot) for a, b in down]
    stances.sort()
    rows = np.array([row for row, _ in stances], dtype=np.intp)
    relative = tree.relative(run.robot.joint_names, plan.joint_positions[rows])
    poses = tree.world(plan.base_poses[rows], relative)
    found = []
    for k, (_, foot) in enumerate(stances):
        sphere = run.robot.limbs[foot].foot
        pose = poses[sphere.link][k]
        centre = pose[:3] + rotate(pose[3:], np.array(sphere.offset))
        found.append((foot, centre - [0.0, 0.0, sphere.radius]))
    return found


def entity(update: Any, name: str, run: Run, time: float, frame: str = WORLD, locked: bool = False) -> Any:
    """A new entity of a SceneUpdate."""
    new = update.entities.add(id=name, frame_id=frame, frame_locked=locked)
    set_stamp(new.timestamp, run, time)
    return new


def paint(color: Any, rgb: tuple[float, float, float], alpha: float = 1.0) -> None:
    """Fill a foxglove.Color."""
    color.r, color.g, color.b, color.a = (*rgb, alpha)


def ball(scene_entity: Any, point: Sequence[float] | Array, diameter: float, rgb: tuple[float, float, float]) -> None:
    """Add a sphere [m]."""
    sphere = scene_entity.spheres.add()
    p = sphere.pose.position
    p.x, p.y, p.z = (float(v) for v in point)
    sphere.pose.orientation.w = 1.0
    sphere.size.x = sphere.size.y = sphere.size.z = diameter
    paint(sphere.color, rgb)


def _support(run: Run) -> Messages:
    from foxglove_schemas_protobuf.LinePrimitive_pb2 import LinePrimitive
    from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate

    trace, pressure, messages = run.trace, center_of_pressure(run.trace), []
    for row in run.scene_rows.tolist():
        update, time = SceneUpdate(), float(trace.times[row])
        corners = hull(trace.contact_points[row, run.contact[row], :2])
        polygon = entity(update, "support", run, time)
        if len(corners) >= 3:
            fan = polygon.triangles.add()
            fan.pose.orientation.w = 1.0
            paint(fan.color, MAGENTA, 0.2)
            for k in range(1, len(corners) - 1):
                for x, y in corners[[0, k, k + 1]].tolist():
                    fan.points.add(x=x, y=y, z=LIFT_M)
        if len(corners) >= 2:
            border = polygon.lines.add(type=LinePrimitive.LINE_LOOP, thickness=0.006)
            border.pose.orientation.w = 1.0
            paint(border.color, MAGENTA)
            for x, y in corners.tolist():
                border.points.add(x=x, y=y, z=LIFT_M)
        ball(entity(update, "center_of_mass", run, time), trace.com[row], 0.03, BLUE)
        ball(entity(update, "center_of_mass_on_ground", run, time), [*trace.com[row, :2], LIFT_M], 0.02, BLUE)
        cop = entity(update, "center_of_pressure", run, time)
        if np.isfinite(pressure[row]).all():
            ball(cop, [*pressure[row], LIFT_M], 0.02, ORANGE)
        messages.append((run.stamp(time), update.SerializeToString()))
    return messages


def _forces(run: Run) -> Messages:
    from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate

    trace, messages = run.trace, []
    force = trace.friction_force + trace.normal_force[..., None] * np.array([0.0, 0.0, 1.0])
    lengths = np.linalg.norm(force, axis=2) * (ARROW_M / (run.robot.mass * GRAVITY))
    for row in run.scene_rows.tolist():
        update, time = SceneUpdate(), float(trace.times[row])
        drawing = entity(update, "forces", run, time)
        for foot in np.flatnonzero(run.contact[row]):
            length = float(lengths[row, foot])
            arrow = drawing.arrows.add(
                shaft_length=0.75 * length, head_length=0.25 * length, shaft_diameter=0.008, head_diameter=0.018
            )
            p, q = arrow.pose.position, arrow.pose.orientation
            p.x, p.y, p.z = trace.contact_points[row, foot].tolist()
            q.x, q.y, q.z, q.w = _from_x_axis(force[row, foot]).tolist()
            paint(arrow.color, RED)
        messages.append((run.stamp(time), update.SerializeToString()))
    return messages


def _footholds(run: Run) -> Messages:
    from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate

    update = SceneUpdate()
    discs = entity(update, "footholds", run, 0.0)
    for foot, point in planned_footholds(run):
        disc = discs.cylinders.add(bottom_scale=1.0, top_scale=1.0)
        p = disc.pose.position
        p.x, p.y, p.z = point[0], point[1], 0.5 * LIFT_M
        disc.pose.orientation.w = 1.0
        disc.size.x = disc.size.y = 2.0 * run.robot.limbs[foot].foot.radius
        disc.size.z = LIFT_M
        paint(disc.color, GREEN, 0.7)
    return [(run.stamp(0.0), update.SerializeToString())]


def _from_x_axis(vector: Array) -> Array:
    """(4,) quaternion that turns the x axis along `vector`."""
    unit = vector / max(float(np.linalg.norm(vector)), 1e-12)
    quaternion = np.array([0.0, -unit[2], unit[1], 1.0 + unit[0]])
    size = float(np.linalg.norm(quaternion))
    return quaternion / size if size > 1e-9 else np.array([0.0, 0.0, 1.0, 0.0])


def _turn(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
