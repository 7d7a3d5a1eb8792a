"""Stands in which a load is picked up or put down: reach, close, lift — lower, open, retract.

All feet that walk stay where they are, rolling as the body moves; the limbs that hold follow the load by
inverse kinematics.  There is nothing to optimise: with the feet and the load given, every joint is.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitforge.errors import InfeasibleMotion, UnsolvedError
from gaitforge.footfall.given import stand_pattern
from gaitforge.footfall.margin import support_margins
from gaitforge.motion.manipulation.box_gap import box_gap
from gaitforge.motion.manipulation.grasp import Grasp, side_grasp
from gaitforge.motion.manipulation.holding import Holding
from gaitforge.motion.manipulation.standing import standing_joints
from gaitforge.motion.plan import Command, MotionPlan
from gaitforge.motion.report import SolveReport
from gaitforge.motion.trajectory import smooth_step
from gaitforge.robot.model import RobotModel
from gaitforge.robot.payload import Load
from gaitforge.robot.rotation import matrices, poses_of
from gaitforge.task.handling import Pick
from gaitforge.task.roles import Carry, Role
from gaitforge.task.scene import SceneObject

Array = NDArray[np.float64]
COLUMNS, SAMPLES = 4, 6
PEAK = 1.875
"""Largest slope of `smooth_step`"""
SPEED_SHARE = 0.4
"""of a joint's speed limit that a stand may use"""
LEAST_S = 1.0
"""[s] a stage takes at least"""
APPROACH = 0.03
"""[m] off the faces from which tips close on the box"""
CLEAR = 0.004
"""[m] that reaching limbs stay away from the box"""
LEAST_MARGIN = 0.01
"""[m] of the centre of mass inside the feet"""


AMPLE = 0.02
"""[m] … that the body is shifted for"""
SHIFT = 0.08
"""[m] ahead, back and aside"""


@dataclass(frozen=True, eq=False)
class State:
    """A robot at rest: where a stage begins or ends."""

    base: Array
    """(6,) in the plan's frame"""
    joints: Array
    """(n_J,)"""


@dataclass(frozen=True, eq=False)
class Carried:
    """A box in the grasp of a robot that walks: what picking it up leads to, and putting it down begins with."""

    box: SceneObject
    pick: Pick
    grasp: Grasp
    reach_height: float
    """[m] of base_link while limbs reach"""
    grasped: Array
    """(6,) pose of the box in base_link when the tips close on it, the body level"""
    pose: Array
    """(6,) … while it is carried"""
    first: Mapping[str, Array]
    """limb → joints (n,) [rad] with the tips on the sides of the box where it is grasped"""
    joints: Mapping[str, Array]
    """limb → joints (n,) [rad] that carry it"""
    efforts: Mapping[str, float]
    """joint → effort limit [N m] that squeezes"""

    @property
    def load(self) -> Load:
        """What the planner counts in the centre of mass."""
        x, y, z = (float(v) for v in self.pose[:3])
        return Load(self.box.mass, (x, y, z))

    @property
    def roles(self) -> dict[str, Role]:
        """limb → its role while the robot carries."""
        return {name: Carry(self.box.name) for name in self.grasp.limbs}

    def holding(self, poses: Array | None = None) -> Holding:
        """What a plan says in which the box is borne; `poses` (N + 1, 6) in base_link when it moves there."""
        still = self.pose[None] if poses is None else poses
        return Holding(self.box.name, still, self.grasp.limbs, self.efforts, self.box.mass, self.pick.grasp)

    def ready(self, pose: Array) -> dict[str, Array]:
        """limb → joints (n,) beside and above a box at `pose` (6,): from here it is reached, to here limbs go back."""
        pick, near = self.pick, self.grasp.joints(pose[None], APPROACH, self.first)
        found = self.grasp.joints(pose[None], pick.ready_aside, near, pick.ready_above)
        return {name: q[0] for name, q in found.items()}

    def path(self, heights: Array) -> Array:
        """(n, 6) poses of the box in base_link at the given heights [m], the tips not turning on its faces."""
        poses = np.tile(self.grasped, (len(heights), 1))
        poses[:, 2] = heights
        held = {name: q[0] for name, q in self.grasp.joints(self.grasped[None], 0.0, self.first).items()}
        return self.grasp.unturned(poses, self.grasped, held)


def carry(robot: RobotModel, box: SceneObject, pick: Pick, place: tuple[float, float, float]) -> Carried:
    """How a robot whose base is at `place` (x, y [m], yaw [rad]) will hold the box that it picks up there.

    Raises `InfeasibleMotion` when a limb does not reach it.
    """
    height = robot.nominal.body_height - pick.crouch
    grasp = side_grasp(robot, pick.limbs, box.size, pick.grip_height, pick.grip_spread)
    base = np.array([place[0], place[1], height, 0.0, 0.0, place[2]])
    R, R_box = matrices(base[3:]), matrices(np.array(box.rpy))
    grasped = poses_of((R.T @ (np.array(box.xyz) - base[:3]))[None], (R.T @ R_box)[None])[0]
    first = Carried(box, pick, grasp, height, grasped, grasped, grasp.first_joints(grasped), {}, {})
    pose = first.path(np.array([grasped[2] + pick.lift - pick.crouch]))[0]
    joints = {n: q[0] for n, q in grasp.joints(pose[None], 0.0, first.first).items()}
    return replace(first, pose=pose, joints=joints, efforts=grasp.efforts(pose, joints, pick.squeeze))


def plan_pick(
    robot: RobotModel, carried: Carried, end: State, roles: Mapping[str, Role], others: Sequence[Holding] = ()
) -> list[MotionPlan]:
    """Reach, close, lift: from where limbs are ready to `end`, the rest in which the robot bears the box.

    `roles`: limb → role of the others that do not walk; `others`: what the robot holds already.  Raises
    `InfeasibleMotion` for a limb that does not reach, and `UnsolvedError` when a limb or the balance is in the way.
    """
    stage, share = _Stage(robot, carried, roles, others), smooth_step(np.linspace(0.0, 1.0, COLUMNS * SAMPLES + 1))
    level = _level(robot, carried, end)
    base = level + share[:, None] * (end.base - level)
    poses = carried.path(carried.grasped[2] + share * (carried.pose[2] - carried.grasped[2]))
    lift = stage.move("lift", base, end, True, poses, np.zeros(len(share)))
    still, there = np.tile(level, (len(share), 1)), np.tile(carried.grasped, (len(share), 1))
    below = State(level, lift.joint_positions[:, 0])
    close = stage.move("close", still, below, True, there, APPROACH * (1.0 - share), borne=False)
    reach = stage.reach("reach", State(level, close.joint_positions[:, 0]), there, share)
    return [reach, close, lift]


def plan_place(
    robot: RobotModel, carried: Carried, start: State, roles: Mapping[str, Role], surface: float,
    others: Sequence[Holding] = (),
) -> list[MotionPlan]:  # fmt: skip
    """Lower, open, retract: from `start`, at rest with the box, to where limbs are ready; it lands at `surface` [m].

    The rest as for `plan_pick`.
    """
    stage, share = _Stage(robot, carried, roles, others), smooth_step(np.linspace(0.0, 1.0, COLUMNS * SAMPLES + 1))
    level = _level(robot, carried, start)
    base = start.base + share[:, None] * (level - start.base)
    down = surface + 0.5 * carried.box.size[2] - level[2]
    poses = carried.path(carried.pose[2] + share * (down - carried.pose[2]))
    lower = stage.move("lower", base, start, False, poses, np.zeros(len(share)))
    still, there = np.tile(level, (len(share), 1)), np.tile(poses[-1], (len(share), 1))
    low = State(level, lower.joint_positions[:, -1])
    opened = stage.move("open", still, low, False, there, APPROACH * share, borne=False)
    retract = stage.reach("retract", State(level, opened.joint_positions[:, -1]), there, share[::-1])
    return [lower, opened, retract]


def rest_of(plan: MotionPlan, first: bool) -> State:
    """The state at the first or last sample of a plan that begins or ends at rest."""
    at = 0 if first else -1
    return State(plan.base_poses[at].copy(), plan.joint_positions[:, at].copy())


def _level(robot: RobotModel, carried: Carried, rest: State) -> Array:
    """(6,) the level base pose to reach from, feet where they are at `rest`, as near to it as balance allows.

    With the limbs ready, with the limbs at the box and with the box in the grasp the centre of mass is to be
    `AMPLE` inside the feet; where no place that the feet reach from has that much, the best one is taken.
    """
    pose = np.array([0.0, 0.0, carried.reach_height, 0.0, 0.0, rest.base[5]])
    free, grasped, ready = rest.joints.copy(), rest.joints.copy(), carried.ready(carried.grasped)
    for name, joints in carried.grasp.joints(carried.grasped[None], 0.0, carried.joints).items():
        rows = robot.joint_indices(robot.limb(name))
        free[rows], grasped[rows] = ready[name], joints[0]
    empty = [robot.center_of_mass(pose, joints) for joints in (free, grasped)]
    load = pose[:3] + matrices(pose[3:]) @ carried.grasped[:3]
    mass = carried.box.mass
    points = np.array([*empty, (robot.mass * empty[1] + mass * load) / (robot.mass + mass)])[:, :2]
    stance = np.array([limb.name in _standing(robot, rest) for limb in robot.limbs])
    feet = robot.foot_positions(rest.base, rest.joints)[None, :, :2]
    line = np.linspace(-SHIFT, SHIFT, 17)
    shifts = np.stack(np.meshgrid(line, line, indexing="ij"), axis=-1).reshape(-1, 2)
    shifts = shifts[np.argsort(np.linalg.norm(shifts, axis=1), kind="stable")]
    places = (rest.base[:2] + shifts)[:, None] + points
    margins = support_margins(feet, stance[None], places.reshape(-1, 2))[0].reshape(-1, len(points)).min(axis=1)
    best = np.argsort(-np.minimum(margins, AMPLE), kind="stable")
    reached = (k for k in best if _reached(robot, rest, np.array([*(rest.base[:2] + shifts[k]), *pose[2:]])))
    pose[:2] = rest.base[:2] + shifts[next(reached, best[0])]
    return pose


def _reached(robot: RobotModel, rest: State, pose: Array) -> bool:
    """Do the feet stay where they are at `rest` when the base goes to `pose` (6,)?"""
    standing = _standing(robot, rest)
    try:
        for limb in robot.limbs:
            if limb.name in standing:
                standing_joints(robot, limb, np.array([rest.base, pose]), rest.joints[robot.joint_indices(limb)], False)
    except InfeasibleMotion:
        return False
    return True


def _standing(robot: RobotModel, rest: State) -> tuple[str, ...]:
    """Limbs whose feet are on the ground."""
    heights = robot.foot_positions(rest.base, rest.joints)[:, 2]
    return tuple(x.name for x, z in zip(robot.limbs, heights, strict=True) if z - x.foot.radius < 1e-3)


@dataclass(frozen=True, eq=False)
class _Stage:
    """What the stages of one pick or place have in common."""

    robot: RobotModel
    carried: Carried
    roles: Mapping[str, Role]
    others: Sequence[Holding]

    def move(
        self, name: str, base: Array, known: State, last: bool, poses: Array, gap: Array, borne: bool = True
    ) -> MotionPlan:
        """Feet stand, tips follow the box at `poses` with a `gap` (n,) [m] to its faces; `known` is one end of it."""
        robot, grasp = self.robot, self.carried.grasp
        joints = np.tile(known.joints, (len(base), 1))
        for limb in robot.limbs:
            if limb.name not in self.roles and limb.name not in grasp.limbs:
                rows = robot.joint_indices(limb)
                joints[:, rows] = standing_joints(robot, limb, base, known.joints[rows], last)
        closed = grasp.joints(poses, 0.0, self.carried.joints)
        opened = grasp.joints(poses, APPROACH, closed)
        share = (gap / APPROACH)[:, None]
        for limb_name in grasp.limbs:
            rows = robot.joint_indices(robot.limb(limb_name))
            joints[:, rows] = closed[limb_name] + share * (opened[limb_name] - closed[limb_name])
        holding = self.carried.holding(poses)
        return self._plan(name, base, joints, holding if borne else replace(holding, mass=0.0))

    def reach(self, name: str, near: State, poses: Array, share: Array) -> MotionPlan:
        """Holding limbs between where they are ready (share 0) and the box (share 1), the rest of the robot still."""
        robot, box = self.robot, self.carried.box
        joints = np.tile(near.joints, (len(share), 1))
        for limb_name, ready in self.carried.ready(poses[0]).items():
            rows = robot.joint_indices(robot.limb(limb_name))
            joints[:, rows] = ready + share[:, None] * (near.joints[rows] - ready)
            gap = box_gap(robot, robot.limb(limb_name), joints[:, rows], poses, box.size)
            if gap < CLEAR:
                raise UnsolvedError(
                    f"{box.name}_{name}: {limb_name} would come {1000 * gap:.0f} mm near it on its way",
                    {"segment": f"{box.name}_{name}", "families": ["clearance"], "limbs": [limb_name], "value": gap,
                     "unit": "m", "advice": "tips that are ready farther from the load, or another place for it"},
                )  # fmt: skip
        return self._plan(name, np.tile(near.base, (len(share), 1)), joints, Holding(box.name, poses))

    def _plan(self, name: str, base: Array, joints: Array, holding: Holding) -> MotionPlan:
        robot, count, full = self.robot, len(base) - 1, f"{self.carried.box.name}_{name}"
        fastest = float((np.abs(np.diff(joints, axis=0)).max(axis=0) / robot.velocity).max())
        seconds = max(LEAST_S, fastest * count / SPEED_SHARE)
        free = {**self.roles, **self.carried.roles}
        pattern = stand_pattern(robot, COLUMNS, free=list(free))
        stance = pattern.contact[:, 0]
        holdings = (holding, *self.others)
        feet = np.array([robot.foot_positions(b, q) for b, q in zip(base, joints, strict=True)])
        com = _center_of_mass(robot, base, joints, holdings)
        margin = min(
            float(support_margins(f[None, :, :2], stance[None], c[None, :2])[0, 0])
            for f, c in zip(feet, com, strict=True)
        )
        if margin < LEAST_MARGIN:
            raise UnsolvedError(
                f"{full}: the centre of mass comes within {1000 * margin:.0f} mm of the edge of the feet",
                {"segment": full, "families": ["balance"], "value": margin, "unit": "m",
                 "advice": "a lighter load, or nearer to the body"},
            )  # fmt: skip
        return MotionPlan(
            name=full, kind="stand", pattern=pattern, times=np.linspace(0.0, seconds, count + 1),
            joint_positions=joints.T.copy(), base_poses=base, com=com, feet=feet,
            weights=_shares(feet, com, stance), command=Command(), roles=free, holdings=holdings,
            joint_velocity_ends=np.zeros((2, joints.shape[1])), base_velocity_ends=np.zeros((2, 6)),
            report=SolveReport("Kinematic", details={"margin_m": margin}),
        )  # fmt: skip


def _center_of_mass(robot: RobotModel, base: Array, joints: Array, holdings: Sequence[Holding]) -> Array:
    """(n, 3) of the robot and of what it bears [m]: a load that stands on something is none of it."""
    moment = robot.mass * np.array([robot.center_of_mass(b, q) for b, q in zip(base, joints, strict=True)])
    mass, turns = np.full(len(base), robot.mass), matrices(base[:, 3:])
    for holding in holdings:
        places = base[:, :3] + np.einsum("nij,nj->ni", turns, np.broadcast_to(holding.poses[:, :3], (len(base), 3)))
        borne = holding.mass * holding.borne(places[:, 2])
        moment, mass = moment + borne[:, None] * places, mass + borne
    return np.asarray(moment / mass[:, None])


def _shares(feet: Array, com: Array, stance: NDArray[np.bool_]) -> Array:
    """(n, 2, n_F) the most even shares of the weight with the centre of mass as centre of pressure."""
    weights = np.zeros((len(feet), 2, feet.shape[1]))
    for k in range(len(feet)):
        rows = np.vstack([feet[k, stance, :2].T, np.ones(int(stance.sum()))])
        weights[k, :, stance] = (np.linalg.pinv(rows) @ [*com[k, :2], 1.0])[:, None]
    return weights
