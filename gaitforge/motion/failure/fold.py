"""Limp limbs folded: the robot crouches, which bends them against the ground, and rises again.

A limb without motors lies on the ground where it was, held by the friction of its joints, and is dragged into the way
of its neighbour.  Its foot sticks to the ground: a body that comes down bends it like a leg of its own.  What is bent
stays bent by friction, and a bent limb is short enough to hang clear of the ground from a body that stands higher.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from gaitforge.errors import UnsolvedError
from gaitforge.footfall.given import stand_pattern
from gaitforge.motion.constraints.placed import Placed
from gaitforge.motion.failure.halt import SHARES
from gaitforge.motion.failure.hanging import gravity_torques, hanging_joints
from gaitforge.motion.failure.raised import hanging_height, highest_stance
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import Command, MotionPlan, Stance
from gaitforge.motion.segment import Segment
from gaitforge.motion.solve import solve_segment
from gaitforge.motion.stance import reaching_joints
from gaitforge.motion.state import end_state, rest_state
from gaitforge.motion.trajectory import Boundary, Discretisation, Guess, smooth_step
from gaitforge.motion.trunk import trunk_corners
from gaitforge.robot.kinematics import feet_in_world
from gaitforge.robot.model import RobotModel
from gaitforge.robot.rotation import matrices
from gaitforge.task.roles import Role

Array = NDArray[np.float64]
SHIFTS = (0.0, 0.03, 0.06, 0.09)
"""[m] that the body comes over the limp feet while it is down: the further, the more they bend"""
KEPT = 0.55
"""Share of the shift that is kept when it rises: going all the way back would straighten limbs whose feet stick"""
CROUCHES = ((0.03, 2.0), (0.045, 2.5), (0.06, 3.0))
"""[m] of the trunk above the ground while it is down, and the time of the way down or up [s], the deepest first"""
LATER = ((0.06, 2.0), (0.06, 3.0))
"""The same for limbs that are folded after others: those that are folded already would be pressed against the stops
of their joints"""
FALLS = 1.25
"""Times its friction that gravity turns a joint of a folded limb: one that is held up there falls down later on"""
COLUMNS = 8
"""Of the way down, and of the way up"""
RISE_S = 2.0
"""[s] of a body that rises straight up"""
DIPS = ((0.04, 2.0), (0.03, 2.5), (0.02, 3.0))
"""[m] that a body sinks which settles the limbs that hang from it, and the time of the way down or up [s]"""


@dataclass(frozen=True, eq=False)
class Folded:
    """Down and up again, and how the limp limbs hang after it."""

    plans: tuple[MotionPlan, MotionPlan]
    postures: Mapping[str, Array]
    """limb → (n,) joint positions [rad] once it hangs free"""


def plan_fold(
    robot: RobotModel, stand: MotionPlan, roles: Mapping[str, Role], limbs: tuple[str, ...], friction: float,
    crouch: tuple[float, float] = CROUCHES[0], *, name: str = "fold", options: MotionOptions | None = None,
) -> Folded:  # fmt: skip
    """Fold the limp `limbs`, of which `stand` ends in the postures that they lie in; `friction` [N m] of their joints.

    `crouch`: height of the trunk above the ground while it is down [m], and the time of the way down, or up [s]; all
    feet that stand stay where they are.  Raises `UnsolvedError` when the robot has no way down and up again.
    """
    options = options or MotionOptions()
    now, (trunk_m, seconds) = end_state(robot, stand, stopped=True), crouch
    failure = UnsolvedError(f"{name}: limbs that would stay up where they are folded", {"segment": name})
    for way in _ways(robot, now, limbs, friction, trunk_m):
        try:
            down = _moved(robot, stand, roles, way.low, f"{name}_down", options, way.pressed, seconds)
            up = _moved(robot, down, roles, way.high, f"{name}_up", options, way.hangs, seconds)
        except UnsolvedError as error:
            failure = error
            continue
        return Folded((down, up), way.hangs)
    raise failure


@dataclass(frozen=True, eq=False)
class _Way:
    """Where the body goes, and what limp limbs make of it."""

    low: Array
    """(6,) base pose at the end of the way down, in the frame of the base before it"""
    high: Array
    """(6,) at the end of the way up, in the frame of the base down there"""
    pressed: Mapping[str, Array]
    hangs: Mapping[str, Array]


def _ways(
    robot: RobotModel, now: Boundary, limbs: tuple[str, ...], friction: float, trunk_m: float = CROUCHES[0][0]
) -> list[_Way]:
    """The least shift with which limbs hang clear of a body as high as it gets comes first, else the largest."""
    aside = _outward(robot, now, limbs)
    found: list[_Way] = []
    for shift in SHIFTS if np.linalg.norm(aside) > 0.5 else (0.0,):
        low = np.array([*(now.base[:2] + shift * aside), trunk_m - trunk_corners(robot)[:, 2].min(), 0.0, 0.0, 0.0])
        high = np.array([*((KEPT - 1.0) * shift * aside), now.base[2], 0.0, 0.0, 0.0])
        pressed = {n: _reach(robot, n, now, low) for n in limbs}
        if any(_stays_up(robot, n, joints, friction) for n, joints in pressed.items()):
            continue
        hangs = {n: hanging_joints(robot, robot.limb(n), joints, friction=friction) for n, joints in pressed.items()}
        found.append(_Way(low, high, pressed, hangs))
    ceiling = highest_stance(robot)
    clear = [way for way in found if hanging_height(robot, way.hangs) <= ceiling]
    return clear + [way for way in reversed(found) if way not in clear]


def fold_groups(
    robot: RobotModel, stand: MotionPlan, limbs: tuple[str, ...], friction: float
) -> tuple[tuple[str, ...], ...]:
    """Limp limbs that are folded together, in this order: those that the body has to come over first, side by side.

    A shift towards one side straightens the limbs of the other.  Limbs that fold well without it come last, together;
    those that are bent already stay bent while the body goes straight down and up.
    """
    now = end_state(robot, stand, stopped=True)
    shifted: dict[str, list[str]] = {}
    others = []
    for name in limbs:
        ways = _ways(robot, now, (name,), friction)
        if ways and np.linalg.norm(ways[0].low[:2] - now.base[:2]) > 1e-9:
            shifted.setdefault(robot.limb(name).side, []).append(name)
        else:
            others.append(name)
    return tuple(tuple(group) for group in (*shifted.values(), others) if group)


def plan_rise(
    robot: RobotModel, start: MotionPlan, height: float, *, name: str = "rise", options: MotionOptions | None = None
) -> MotionPlan:
    """From a low stand, its body `height` [m] above the ground, to where `start` begins.

    Limp limbs are lifted off the ground by a body that goes straight up: one that sways on its way is carried by them
    for a moment.  Raises `UnsolvedError` when the robot has no such way.
    """
    low = np.array([0.0, 0.0, height, 0.0, 0.0, 0.0])
    return backwards(_sunk(robot, start, low, name, options, RISE_S), name)


def plan_dip(
    robot: RobotModel, start: MotionPlan, dip: tuple[float, float] = DIPS[0], *, name: str = "dip",
    options: MotionOptions | None = None,
) -> tuple[MotionPlan, MotionPlan]:  # fmt: skip
    """From where `start` begins down and up again: limbs that touch the ground up there fold the rest.

    `dip`: how far [m], and the time of the way down, or up [s].  Raises `UnsolvedError` when there is no such way.
    """
    low = start.base_poses[0] * [0.0, 0.0, 1.0, 1.0, 1.0, 0.0] - [0.0, 0.0, dip[0], 0.0, 0.0, 0.0]
    down = _sunk(robot, start, low, f"{name}_down", options, dip[1])
    return down, backwards(down, f"{name}_up")


def _sunk(
    robot: RobotModel, start: MotionPlan, base: Array, name: str, options: MotionOptions | None, seconds: float
) -> MotionPlan:
    """From where `start` begins down to `base` (6,), in the frame of the base up there."""
    bare = _unobstructed(robot, start.limp)
    return _moved(bare, backwards(start, name), start.roles, base, name, options or MotionOptions(), {}, seconds)


def _unobstructed(robot: RobotModel, limbs: tuple[str, ...]) -> RobotModel:
    """The robot without the bodies of limp limbs: where they hang once it stands high is ground while it is low."""
    limp = {link for name in limbs for link in robot.limb(name).links}
    return replace(robot, capsules=tuple(c for c in robot.capsules if c.link not in limp))


def backwards(plan: MotionPlan, name: str) -> MotionPlan:
    """The same way from its end to its start; both are taken for rests."""
    joints, pattern = plan.joint_positions[:, ::-1].copy(), replace(plan.pattern, contact=plan.pattern.contact[:, ::-1])
    return replace(
        plan, name=name, pattern=pattern, joint_positions=joints, base_poses=plan.base_poses[::-1], com=plan.com[::-1],
        feet=plan.feet[::-1], weights=plan.weights[::-1, ::-1], joint_velocity_ends=np.zeros((2, len(joints))),
        base_velocity_ends=np.zeros((2, 6)),
    )  # fmt: skip


def _outward(robot: RobotModel, now: Boundary, limbs: tuple[str, ...]) -> Array:
    """(2,) mean of the directions from the hips of limbs to their feet, in the plane."""
    feet, hips = robot.foot_positions(now.base, now.joints), _hips(robot)
    away = np.array([feet[robot.limb_names.index(n), :2] - now.base[:2] - hips[n] for n in limbs])
    return np.asarray((away / np.linalg.norm(away, axis=1, keepdims=True)).mean(axis=0))


def _hips(robot: RobotModel) -> dict[str, Array]:
    """limb → (2,) of its first joint [m, base frame]."""
    from gaitforge.robot.kinematics import evaluate_limbs

    poses = evaluate_limbs(robot, np.array(robot.nominal.posture, dtype=float)[None])
    return {limb.name: poses[i].origins[0, 0, :2] for i, limb in enumerate(robot.limbs)}


def _reach(robot: RobotModel, name: str, now: Boundary, base: Array) -> Array:
    """(n,) joints that keep a foot in its place while the body goes from where it is to `base` (6,)."""
    limb = robot.limb(name)
    foot = robot.foot_positions(now.base, now.joints)[robot.limb_names.index(name)]
    goal = matrices(base[3:6]).T @ (foot - base[:3])
    return reaching_joints(robot, limb, goal, now.joints[robot.joint_indices(limb)])


def _stays_up(robot: RobotModel, name: str, joints: Array, friction: float) -> bool:
    """Whether friction may hold the limb where it is folded, its foot in the air."""
    return float(np.abs(gravity_torques(robot, robot.limb(name), joints)).max()) < FALLS * friction


def _moved(
    robot: RobotModel, before: MotionPlan, roles: Mapping[str, Role], base: Array, name: str, options: MotionOptions,
    limp: Mapping[str, Array], seconds: float,
) -> MotionPlan:  # fmt: skip
    """From rest to rest with the body at `base` (6,), feet where they are; limp limbs go to `limp` as they do."""
    now = end_state(robot, before, stopped=True)
    goal = now.joints.copy()
    for limb in robot.limbs:
        rows = robot.joint_indices(limb)
        if limb.name in limp:
            goal[rows] = limp[limb.name]
        elif limb.name not in roles:
            goal[rows] = _reach(robot, limb.name, now, base)
    start = replace(now, stance=Stance(now.base[2:5].copy(), now.joints))
    rest = rest_state(robot, now.joints, base, Stance(base[2:5].copy(), goal))
    pattern = stand_pattern(robot, COLUMNS, free=[n for n in robot.limb_names if n in roles])
    grid = Discretisation(pattern, options.samples_per_column, seconds, Command(), start, rest)
    walking = tuple(i for i, row in enumerate(pattern.contact) if row.any())
    guess = partial(_guess, robot, now, base, goal)
    segment = Segment(name, "stand", robot, grid, walking, now.joints, guess, dict(roles))
    x, y, z, roll, pitch, yaw = base.tolist()
    families = (*options.constraints, Placed(pose=(x, y, z, roll, pitch, yaw)))
    plan = solve_segment(segment, replace(options, stability_shares=SHARES, constraints=families))
    return _showing(robot, plan, limp, now)


def _guess(robot: RobotModel, now: Boundary, base: Array, joints: Array, grid: Discretisation) -> Guess:
    """Smoothly from here to there."""
    share = smooth_step(np.linspace(0.0, 1.0, grid.samples))[:, None]
    feet = np.tile(robot.foot_positions(now.base, now.joints), (grid.samples, 1, 1))
    for i, limb in enumerate(robot.limbs):
        feet[grid.ground[:, i], i, 2] = limb.foot.radius
    return Guess(now.base + share * (base - now.base), now.joints + share * (joints - now.joints), feet)


def _showing(robot: RobotModel, plan: MotionPlan, limp: Mapping[str, Array], now: Boundary) -> MotionPlan:
    """The plan with limp limbs going from where they are to where they are expected: nobody drives them there."""
    joints = plan.joint_positions.copy()
    share = smooth_step(np.linspace(0.0, 1.0, len(plan.times)))
    for name, posture in limp.items():
        rows = robot.joint_indices(robot.limb(name))
        joints[rows] = now.joints[rows, None] + share * (posture - now.joints[rows])[:, None]
    com, feet = robot.center_of_mass(plan.base_poses, joints.T), feet_in_world(robot, plan.base_poses, joints.T)
    return replace(plan, joint_positions=joints, com=com, feet=feet)
