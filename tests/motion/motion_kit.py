"""Segments with random starting points, patterns by hand, and splines measured with Pinocchio alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import pinocchio

from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion.bodies import closest_pairs, limb_capsules
from gaitforge.motion.constraints.clearance import Clearance
from gaitforge.motion.constraints.effort import Effort
from gaitforge.motion.constraints.joint_speed import JointSpeed
from gaitforge.motion.family import Family
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import Command, MotionPlan
from gaitforge.motion.problem import Problem
from gaitforge.motion.segment import Segment
from gaitforge.motion.solvers.ipopt import Ipopt
from gaitforge.motion.solvers.structured import Structured
from gaitforge.motion.trajectory import Boundary, Discretisation, Guess, Trajectory
from gaitforge.robot.kinematics import evaluate_limb, limb_parameters
from gaitforge.robot.model import RobotModel

PATIENT = MotionOptions(solver=Structured(fallback=Ipopt(max_seconds=120.0)))
"""The default options, but a busy machine is no reason to give up."""
TRIPOD = FootfallPattern.from_rows(
    {
        "L1": "000000111111", "L2": "111111000000", "L3": "000000111111",
        "R1": "111111000000", "R2": "000000111111", "R3": "111111000000",
    }
)  # fmt: skip
"""Alternating tripod: all six feet change at the same time."""
PENTA = FootfallPattern.from_rows(
    {
        "L1": "001111111111", "L2": "111111110001", "L3": "111000011111",
        "R1": "000000000000", "R2": "111000011111", "R3": "111111110001",
    }
)  # fmt: skip
"""Five limbs walk, R1 is free."""
CHANGE = FootfallPattern.from_rows(
    {
        "L1": "00011111111", "L2": "11111111001", "L3": "00011111111",
        "R1": "11111111000", "R2": "00011111111", "R3": "11111111001",
    },
    cyclic=False,
)  # fmt: skip
"""From six walking limbs to five."""


def random_guess(robot: RobotModel, seed: int, spread: float = 0.15):
    """A guess function of random poses near the nominal one; feet where Pinocchio says that they are."""

    def guess(grid: Discretisation) -> Guess:
        rng = np.random.default_rng(seed)
        base = rng.normal(0.0, 0.3 * spread, (grid.samples, 6))
        base[:, 2] += robot.nominal.body_height
        joints = robot.nominal.posture + rng.normal(0.0, spread, (grid.samples, len(robot.joint_names)))
        for limb in robot.limbs:  # tool joints stay where the kinematics take them to be
            for name in limb.tool_joints:
                joints[:, robot.joint_names.index(name)] = robot.nominal.posture[robot.joint_names.index(name)]
        feet = np.array([robot.foot_positions(b, q) for b, q in zip(base, joints, strict=True)])
        return Guess(base, joints, feet)

    return guess


def boundary(robot: RobotModel, seed: int, rest: bool = False) -> Boundary:
    """A random state near the nominal one."""
    rng = np.random.default_rng(seed)
    base = rng.normal(0.0, 0.03, 6) + np.array([0, 0, robot.nominal.body_height, 0, 0, 0])
    n = len(robot.joint_names)
    joints = robot.nominal.posture + rng.normal(0.0, 0.05, n)
    ground = rng.random(len(robot.limbs)) < 0.5
    speeds = (rng.normal(0.0, 0.3, size) for size in (n, 6, 3))
    if rest:
        return Boundary(joints, np.zeros(n), base, np.zeros(6), np.zeros(3), ground & False, rest=True)
    q, b, c = speeds
    return Boundary(joints, q, base, b, c, ground)


def gait_segment(robot: RobotModel, pattern: FootfallPattern, command: Command, r: int = 1, seed: int = 0) -> Segment:
    """A cyclic segment of 2 s."""
    grid = Discretisation(pattern, r, 2.0, command)
    walking = tuple(i for i, row in enumerate(pattern.contact) if row.any())
    return Segment(
        "gait", "gait", robot, grid, walking, robot.nominal.held_posture, random_guess(robot, seed), roles={}
    )


def open_segment(
    robot: RobotModel,
    pattern: FootfallPattern,
    kind: str,
    r: int = 1,
    seed: int = 0,
    resting: tuple[bool, bool] = (False, False),
) -> Segment:
    """A transition, or with an end at rest a stand, between random states."""
    ends = [boundary(robot, seed + k, rest) for k, rest in enumerate(resting)]
    command = Command(0.05, 0.4, 0.2)
    grid = Discretisation(pattern, r, 1.2, command, *ends)
    walking = tuple(i for i, row in enumerate(pattern.contact) if row.any())
    guess = random_guess(robot, seed)
    return Segment(kind, kind, robot, grid, walking, robot.nominal.posture, guess, roles={})  # type: ignore[arg-type]


@dataclass(frozen=True, eq=False)
class Instance:
    """A problem with every family in it, and a random point."""

    problem: Problem
    trajectory: Trajectory
    x: np.ndarray


def instance(
    segment: Segment,
    options: MotionOptions | None = None,
    seed: int = 0,
    spread: float = 0.05,
    more: Sequence[Family] = (),
) -> Instance:
    """Build a segment's problem with families on request and `more` added; the point is the guess, disturbed."""
    guess = segment.make_guess(segment.grid)
    extra = [JointSpeed(0.7), Effort(0.7), Clearance(near_pairs(segment, guess, 12), 0.004)]
    problem, trajectory = segment.build(options or MotionOptions(), [*extra, *more])
    low, high = problem.bounds
    x = problem.x0 + np.random.default_rng(seed).normal(0.0, spread, problem.size)
    return Instance(problem, trajectory, np.where(low == high, low, x))


def near_pairs(segment: Segment, guess: Guess, count: int):
    """Some pairs of points on bodies of different limbs, moving and resting ones."""
    robot = segment.robot
    joints = np.tile(segment.fixed_joints, (segment.grid.samples, 1))
    for i in segment.moving:
        rows = robot.joint_indices(robot.limbs[i])
        joints[:, rows] = guess.joints[:, rows]
    poses = {
        i: evaluate_limb(joints[:, robot.joint_indices(limb)], limb_parameters(robot, limb))
        for i, limb in enumerate(robot.limbs)
    }
    found = [
        c
        for c in closest_pairs(limb_capsules(robot), poses, 0.15)
        if {c.first.limb, c.second.limb} & set(segment.moving)
    ]
    mixed = [c for c in found if not {c.first.limb, c.second.limb} <= set(segment.moving)]
    return tuple(mixed[: count // 2] + found[: count - len(mixed[: count // 2])])


def feet_in_motion(robot: RobotModel, plan: MotionPlan, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Centres of the foot spheres [m] and velocities of their lowest points [m/s], (n, n_F, 3) each.

    By Pinocchio's own frames of the plan's splines: none of the project's kinematics is used.
    """
    model, data = robot.pin, robot.pin.createData()
    frames = [model.getFrameId(limb.foot.link, pinocchio.FrameType.BODY) for limb in robot.limbs]
    centres = np.zeros((len(times), len(frames), 3))
    velocities = np.zeros_like(centres)
    splines = (plan.base_spline, plan.joint_spline)
    (base, joints), (rates, speeds) = ([s(times, k) for s in splines] for k in (0, 1))
    for n in range(len(times)):
        q = robot.configuration(base[n], joints[n])
        v = robot.velocity_vector(base[n], rates[n], speeds[n])
        pinocchio.forwardKinematics(model, data, q, v)
        pinocchio.updateFramePlacements(model, data)
        for i, frame in enumerate(frames):
            foot = robot.limbs[i].foot
            arm = data.oMf[frame].rotation @ np.array(foot.offset)
            motion = pinocchio.getFrameVelocity(model, data, frame, pinocchio.LOCAL_WORLD_ALIGNED)
            centres[n, i] = data.oMf[frame].translation + arm
            velocities[n, i] = motion.linear + np.cross(motion.angular, arm - np.array([0.0, 0.0, foot.radius]))
    return centres, velocities


def held(plan: MotionPlan, times: np.ndarray) -> np.ndarray:
    """(n, n_F) planned contact of the interval that each time lies in."""
    columns = np.minimum((times / plan.duration * plan.pattern.columns).astype(int), plan.pattern.columns - 1)
    return plan.pattern.contact[:, columns].T


def on_ground(pattern: FootfallPattern) -> np.ndarray:
    """(m + 1, n_F) on the ground at each column's border: in stance before or after it; open ends see one side."""
    rows = []
    for k in range(pattern.columns + 1):
        around = [k - 1, k]
        if pattern.cyclic:
            around = [j % pattern.columns for j in around]
        rows.append(np.any([pattern.contact[:, j] for j in around if 0 <= j < pattern.columns], axis=0))
    return np.array(rows)


def brute_gap(ends: list[tuple[np.ndarray, np.ndarray, float]], count: int = 60) -> float:
    """Smallest gap between any two capsules (a, b, radius), by sampling both axes [m]; never below the truth."""
    share = np.linspace(0.0, 1.0, count)[:, None]
    points = [a + share * (b - a) for a, b, _ in ends]
    return min(
        float(np.linalg.norm(points[i][:, None] - points[j][None], axis=2).min()) - ends[i][2] - ends[j][2]
        for i, j in combinations(range(len(ends)), 2)
    )
