"""A run made by hand: a smooth made-up motion and a made-up simulation of it, for any robot."""

from __future__ import annotations

import numpy as np

from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion.plan import Command, MotionPlan
from gaitforge.motion.report import SolveReport
from gaitforge.motion.timeline import Aim, Entry, Timeline
from gaitforge.robot.model import RobotModel
from gaitforge.task.roles import Held
from gaitforge.task.scene import Scene, SceneObject
from gaitforge.verify.trace import Trace, UnplannedContact
from gaitforge.verify.verdict import Check, Verdict

SPEED = 0.064
START_NS = 1_700_000_000_000_000_000
SCENE = Scene(
    (
        SceneObject("pipe", "pipe", (2.0, 0.1, 0.25), (0.0, 0.0, 0.2), radius=0.12),
        SceneObject("box", "box", (1.0, -0.8, 0.1), size=(0.3, 0.2, 0.2)),
    )
)


def make_plan(robot: RobotModel, name: str, kind: str, contact: np.ndarray, seconds: float, speed: float) -> MotionPlan:
    """A body that moves straight ahead while every joint swings a little; feet and CoM follow from P."""
    m, n_f = contact.shape[1], len(robot.limbs)
    times = np.linspace(0.0, seconds, 2 * m + 1)
    phase = 2.0 * np.pi * times / seconds
    amplitude = 0.05 * np.linspace(0.5, 1.0, len(robot.joint_names))[:, None]
    p = robot.nominal.posture[:, None] + amplitude * np.sin(phase + np.arange(len(robot.joint_names))[:, None])
    base = np.zeros((len(times), 6))
    base[:, 0], base[:, 2] = speed * times, robot.nominal.body_height
    base[:, 1], base[:, 5] = 0.002 * np.sin(phase), 0.01 * np.sin(phase)
    p[:, -1], base[-1, 1:] = p[:, 0], base[0, 1:]
    ends = None if kind == "gait" else np.zeros((2, len(robot.joint_names)))
    locomotive = contact.any(axis=1)
    return MotionPlan(
        name=name,
        kind=kind,
        pattern=FootfallPattern(contact, robot.limb_names, cyclic=kind == "gait", source="program"),
        times=times,
        joint_positions=p,
        base_poses=base,
        com=np.array([robot.center_of_mass(b, q) for b, q in zip(base, p.T, strict=True)]),
        feet=np.array([robot.foot_positions(b, q) for b, q in zip(base, p.T, strict=True)]),
        weights=np.full((len(times), 2, n_f), 1.0 / n_f),
        command=Command(speed=speed),
        roles={limb: Held() for limb, walks in zip(robot.limb_names, locomotive, strict=True) if not walks},
        joint_velocity_ends=ends,
        base_velocity_ends=None if ends is None else np.array([[speed, 0, 0, 0, 0, 0]] * 2, dtype=float),
        report=SolveReport("Solve_Succeeded", 12, 0.25, 1.5, 1e-9),
        relaxed=("gap rule",) if kind == "transition" else (),
    )


def make_timeline(robot: RobotModel) -> Timeline:
    """Stand, two cycles of a tripod, a transition, three cycles without the first limb, stand."""
    n_f = len(robot.limbs)
    first = np.arange(n_f) % 2 == (np.arange(n_f) >= (n_f + 1) // 2)
    tripod = np.stack([first if j < 6 else ~first for j in range(12)], axis=1)
    other = tripod.copy()
    other[0] = False
    move = np.concatenate([tripod[:, :5], other[:, 5:10]], axis=1)
    plans = (
        (make_plan(robot, "start", "stand", np.ones((n_f, 4), dtype=bool), 0.5, 0.0), 1),
        (make_plan(robot, "all", "gait", tripod, 2.0, SPEED), 2),
        (make_plan(robot, "all to five", "transition", move, 1.25, SPEED), 1),
        (make_plan(robot, "five", "gait", other, 2.0, SPEED), 3),
        (make_plan(robot, "stop", "stand", np.ones((n_f, 4), dtype=bool), 0.5, 0.0), 1),
    )
    entries, start, x = [], 0.0, 0.0
    for plan, cycles in plans:
        entries.append(Entry(plan, cycles, start, np.array([x, 0.0, 0.0])))
        start, x = entries[-1].end, x + cycles * plan.base_poses[-1, 0]
    return Timeline(robot, tuple(entries), *_aim(robot, entries))


def _aim(robot: RobotModel, entries: list[Entry]) -> tuple:
    from scipy.interpolate import CubicSpline

    if not robot.tools:
        return ((), ())
    start, end = entries[3].start, entries[3].end
    tool = robot.tools[0]
    knots = np.linspace(start, end, 9)
    rows = robot.joint_indices(robot.limb(tool.limb))[:2]
    splines = [(int(r), CubicSpline(knots, 0.1 * np.sin(knots + r)), start, end) for r in rows]
    return (Aim(tool.limb, tool.name, np.array([2.0, 0.1, 0.25]), start, end),), tuple(splines)


def make_trace(timeline: Timeline, rate: float = 240.0) -> Trace:
    """A simulation that follows the plan with small waves and contacts 20 ms late."""
    robot = timeline.robot
    times = np.arange(int(timeline.duration * rate) + 1) / rate
    plan = timeline.sample(times)
    n = len(times)
    wave = 0.01 * np.sin(7.0 * times)[:, None]
    base = plan.base_poses + 0.1 * wave * np.array([1.0, 1.0, 0.2, 1.0, 1.0, 1.0])
    contact = timeline.sample(np.maximum(times - 0.02, 0.0)).contact
    weight = robot.mass * 9.81
    normal = contact * weight / np.maximum(contact.sum(axis=1, keepdims=True), 1)
    feet = np.array([robot.foot_positions(b, q) for b, q in zip(base[::24], plan.joint_positions[::24], strict=True)])
    feet = feet[np.minimum(np.arange(n) // 24, len(feet) - 1)]
    tools = [tool.name for tool in robot.tools]
    aimed = timeline.aims[0].start if timeline.aims else np.inf
    return Trace(
        times=times,
        plan=plan,
        base_poses=base,
        joint_positions=plan.joint_positions + wave,
        joint_velocities=plan.joint_velocities,
        joint_torques=0.5 * np.ones_like(plan.joint_positions) + wave,
        normal_force=normal,
        friction_force=normal[..., None] * np.array([0.1, 0.02, 0.0]),
        contact_points=feet * np.array([1.0, 1.0, 0.0]),
        slip_speed=0.001 * contact,
        feet=feet,
        com=base[:, :3] + np.array([0.005, 0.0, -0.01]),
        margin=0.02 + wave[:, 0],
        pointing={name: np.where(times >= aimed, 0.01, np.nan) for name in tools[:1]},
        sight={name: np.ones(n, dtype=bool) for name in tools[:1]},
        unplanned=(UnplannedContact(3.0, f"{robot.limb_names[1]} shin on ground", 4.2),),
    )


def make_verdict(robot: RobotModel) -> Verdict:
    """A run of which one check failed."""
    timeline = make_timeline(robot)
    checks = (
        Check("speed", "all", "pybullet", 0.0634, 0.05, "m/s", True),
        Check("tilt", "five", "pybullet", 2.4, 2.0, "deg", False),
        Check("cost_of_transport", "five", "pybullet", float("nan"), None, "-", True),
    )
    return Verdict("pybullet", checks, make_trace(timeline), timeline, (0.0, 0.0634, 0.0612, 0.0641, 0.0))
