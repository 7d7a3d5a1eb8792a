"""Segments laid one after the other in the world, and tool limbs aimed along the way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from gaitforge.errors import InputError, Problem
from gaitforge.motion.aim import aim_joints
from gaitforge.motion.plan import MotionPlan, carry
from gaitforge.motion.timeline import Aim, Entry, Timeline, place
from gaitforge.motion.trajectory import smooth_step
from gaitforge.robot.limbs import Limb
from gaitforge.robot.model import RobotModel
from gaitforge.task.roles import Tool
from gaitforge.task.scene import Scene

Array = NDArray[np.float64]
KNOT_S = 1 / 60
"""[s] between the knots of an aimed joint's spline"""


def build_timeline(
    robot: RobotModel, segments: Sequence[tuple[MotionPlan, int]], scene: Scene | None = None
) -> Timeline:
    """Each (plan, cycles) begins where the one before ended; world-frame tool targets are followed.

    The rows of a tool limb that looks at a fixed point are recomputed from the planned base pose,
    from the end of the segment before its first gait on; in that segment, once the limb is off the
    ground for good, they are blended in, and in a transition to something else they are blended out
    before the limb lands.  Raises `InputError` for targets that do not exist.
    """
    timeline = Timeline(robot, laid_out(segments))
    aims = _aims(robot, timeline, scene or Scene())
    for aim, run in aims:  # each on top of those before: one target may follow another
        pieces = _override(robot, timeline, aim, run)
        timeline = replace(timeline, aims=(*timeline.aims, aim), overrides=(*timeline.overrides, *pieces))
    return timeline


def laid_out(segments: Sequence[tuple[MotionPlan, int]]) -> tuple[Entry, ...]:
    """Entries for (plan, cycles), each from where the one before it ended; the first at the origin of the world."""
    entries: list[Entry] = []
    start = 0.0
    for plan, cycles in segments:
        # A gait is the same gait anywhere, so the optimiser leaves open where along x it lies.
        origin = _origin(plan, last_pose(entries[-1]) if entries else np.zeros(6))
        entries.append(Entry(plan, cycles, start, origin))
        start = entries[-1].end
    return tuple(entries)


def last_pose(entry: Entry) -> Array:
    """(6,) where the base is in the world when an entry ends."""
    plan = entry.plan
    end = carry(plan.base_poses[-1:], plan.base_poses[0], plan.base_poses[-1], entry.cycles - 1)
    return np.asarray(place(end, entry.origin)[0])


def _origin(plan: MotionPlan, pose: Array) -> Array:
    """(3,) x, y, yaw of the frame in which the plan's first base pose is `pose` in the plane."""
    first = plan.base_poses[0]
    yaw = pose[5] - first[5]
    c, s = np.cos(yaw), np.sin(yaw)
    x = pose[0] - (c * first[0] - s * first[1])
    y = pose[1] - (s * first[0] + c * first[1])
    return np.array([x, y, yaw])


def tool_target(role: Tool, scene: Scene) -> Array:
    """(3,) the point a tool role looks at, names resolved through the scene; InputError when there is none."""
    if not isinstance(role.look_at, str):
        return np.array(role.look_at)
    try:
        return scene.point(role.look_at)
    except KeyError:
        expected = "one of " + ", ".join(scene.point_names()) if scene.point_names() else "a point [m]"
        raise InputError(Problem("task", "look_at", repr(role.look_at), expected)) from None


def _aims(robot: RobotModel, timeline: Timeline, scene: Scene) -> list[tuple[Aim, tuple[int, int]]]:
    """Runs of entries in which one limb keeps looking at one world point, and the entries they span."""
    found = []
    for limb in robot.limbs:
        tool = robot.tool(limb.name)
        roles = [e.plan.roles.get(limb.name) for e in timeline.entries]
        index = 0
        while index < len(roles):
            role, first = roles[index], index
            while index < len(roles) and roles[index] == role:
                index += 1
            if tool is None or not isinstance(role, Tool) or role.frame != "world":
                continue
            settled = next((i for i in range(first, index) if _is_free(timeline.entries[i], limb)), None)
            if settled is None:
                continue
            begin, end = timeline.entries[settled].start, timeline.entries[index - 1].end
            found.append((Aim(limb.name, tool.name, tool_target(role, scene), begin, end), (settled, index)))
    return found


def _is_free(entry: Entry, limb: Limb) -> bool:
    """Has the limb nothing else to do?  In a transition, stance or not, it is on its way from its last step."""
    return entry.plan.kind != "transition" and not entry.plan.pattern.row(limb.name).any()


def _override(
    robot: RobotModel, timeline: Timeline, aim: Aim, run: tuple[int, int]
) -> list[tuple[int, CubicSpline, float, float]]:
    """(joint row, spline, start, end) of an aimed limb: blended in, on target, blended out.

    What is blended is the way from the planned posture to the aimed one, which is short: the plan
    itself brings the limb into its posture, and a blend of the whole way would double its speed.
    """
    limb, tool = robot.limb(aim.limb), next(t for t in robot.tools if t.name == aim.tool)
    rows = robot.joint_indices(limb)
    begin, end = _free_from(timeline, run[0], limb), _free_until(timeline, run[1], limb)
    times = np.linspace(begin, end, max(8, int(np.ceil((end - begin) / KNOT_S)) + 1))
    plan = timeline.sample(times)
    settled = timeline.sample(np.clip(times, aim.start, aim.end - 1e-6)).joint_positions[:, rows]
    aimed = aim_joints(robot, limb, tool, plan.base_poses, aim.target, settled[-1])
    share = np.minimum(_risen(times - begin, aim.start - begin), _risen(end - times, end - aim.end))
    values = plan.joint_positions[:, rows] + smooth_step(share)[:, None] * (aimed - settled)
    speeds = plan.joint_velocities[:, rows]
    pieces = []
    for column, row in enumerate(rows):
        first = (1, speeds[0, column]) if begin < aim.start else "not-a-knot"
        last = (1, speeds[-1, column]) if end > aim.end else "not-a-knot"
        pieces.append((int(row), CubicSpline(times, values[:, column], bc_type=(first, last)), begin, end))
    return pieces


def _risen(since: Array, duration: float) -> Array:
    """(n,) 0 → 1 over a duration; 1 all along when there is none."""
    return np.clip(since / duration, 0.0, 1.0) if duration > 1e-9 else np.ones_like(since)


def _free_from(timeline: Timeline, settled: int, limb: Limb) -> float:
    """When the limb has left the ground for good before entry `settled` [s]; that entry's start when there is none."""
    start = timeline.entries[settled].start
    if settled == 0:
        return start
    before = timeline.entries[settled - 1]
    row = before.plan.pattern.row(limb.name)
    if before.plan.kind == "gait" or row[-1]:
        return start
    columns = before.plan.pattern.columns
    lifted = columns - int(np.argmax(row[::-1])) if row.any() else 0
    return before.end - before.plan.duration * (1 - lifted / columns)


def _free_until(timeline: Timeline, following: int, limb: Limb) -> float:
    """When the limb first lands in the transition `following` [s]; that entry's start when it is no transition."""
    if following == len(timeline.entries):
        return timeline.duration
    after = timeline.entries[following]
    row = after.plan.pattern.row(limb.name)
    if after.plan.kind != "transition":
        return after.start
    landed = int(np.argmax(row)) if row.any() else len(row)
    return after.start + after.plan.duration * landed / len(row)
