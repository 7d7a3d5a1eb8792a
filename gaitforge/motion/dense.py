"""What the spline does between the samples, seen densely: the promises of the samples, measured."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.bodies import Closest, closest_pairs, housings, limb_capsules
from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.shins import LowPoint, low_points
from gaitforge.motion.trunk import closest_to_trunk, trunk_height
from gaitforge.robot.kinematics import LimbPoses, evaluate_limbs
from gaitforge.robot.model import RobotModel
from gaitforge.robot.rotation import matrices

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class DenseReport:
    """Worst values over the whole segment."""

    speed_ratio: Array
    """(n_J,) |q̇| over its limit"""
    limit_excess: Array
    """(n_J,) [rad] beyond the position limits (negative: inside)"""
    penetration: float
    """[m] deepest a foot sphere dips below the ground"""
    lift: float
    """[m] highest a stance foot leaves the ground"""
    slip: float
    """[m] largest way of a contact point in one stance, rolling taken out"""
    swing_clearance: float
    """[m] lowest a swinging foot is away from landing and lifting (mid-swing), inf without swings"""
    trunk_height: float
    """[m] lowest that a corner of the trunk comes"""
    close: tuple[Closest, ...]
    """Bodies nearer to each other than the margin asked for, about each sample: limbs to limbs and to the trunk"""
    ignored: tuple[tuple[str, str], ...]
    """Names of bodies that overlap in the nominal posture, and are not kept apart (`housings`)"""
    low: tuple[LowPoint, ...]
    """Points of limbs, feet left out, that come lower than the margin"""

    @property
    def gap(self) -> float:
        """[m] smallest gap among `close` (inf when nothing is close)."""
        return min((c.gap for c in self.close), default=float("inf"))

    def as_dict(self) -> dict[str, Any]:
        """For the summary: plain numbers."""
        return {
            "speed_ratio": float(self.speed_ratio.max()),
            "limit_excess_rad": float(self.limit_excess.max()),
            "penetration_m": self.penetration,
            "lift_m": self.lift,
            "slip_m": self.slip,
            "swing_clearance_m": self.swing_clearance,
            "gap_m": self.gap,
            "ignored_bodies": [list(pair) for pair in self.ignored],
            "trunk_height_m": self.trunk_height,
            "limb_height_m": min((p.height for p in self.low), default=float("inf")),
        }


def check_densely(robot: RobotModel, plan: MotionPlan, margin: float, per_interval: int = 4) -> DenseReport:
    """Sample the splines of a plan `per_interval` times an interval and measure; `margin` [m] between bodies."""
    intervals = len(plan.times) - 1
    times = np.linspace(0.0, plan.duration, intervals * per_interval + 1)
    joints, rates = plan.joint_spline(times), plan.joint_spline(times, 1)
    base = plan.base_spline(times)
    poses = evaluate_limbs(robot, joints)
    held = np.repeat(plan.pattern.contact.T, plan.samples_per_column * per_interval, axis=0)
    driven = np.array([limb.name not in plan.limp for limb in robot.limbs])
    deep, lift, slip, clear = _feet(robot, poses, base, held, plan.pattern.cyclic, driven)
    beside = housings(robot)
    near = closest_pairs(limb_capsules(robot), poses, margin, per_interval)
    close = [c for c in near if (c.first, c.second) not in beside]
    close += closest_to_trunk(robot, poses, margin, per_interval)
    return DenseReport(
        speed_ratio=np.abs(rates).max(axis=0) / robot.velocity,
        limit_excess=np.maximum(joints - robot.upper, robot.lower - joints).max(axis=0),
        penetration=deep,
        lift=lift,
        slip=slip,
        swing_clearance=clear,
        trunk_height=trunk_height(robot, base),
        close=tuple(close),
        ignored=tuple(sorted((a.name, b.name) for a, b in beside)),
        low=low_points(robot, poses, base, margin),
    )


def _feet(
    robot: RobotModel,
    poses: Mapping[int, LimbPoses],
    base: Array,
    held: NDArray[np.bool_],
    cyclic: bool,
    driven: NDArray[np.bool_],
) -> tuple[float, float, float, float]:
    """Penetration, lift in stance, slip in a stance, mid-swing clearance, each the worst of all feet; held (n, n_F).

    Limbs that are not `driven` (n_F,) give way to the ground.
    """
    turns, radius = matrices(base[:, 3:6]), np.array([limb.foot.radius for limb in robot.limbs])
    foot = np.stack([pose.foot for pose in poses.values()], axis=1)  # (n + 1, n_F, 3)
    centre = base[:, None, :3] + foot @ turns.swapaxes(1, 2)
    height = centre[..., 2] - radius
    rolled = turns[:, None] @ np.stack([pose.rotation for pose in poses.values()], axis=1)
    way = _creep(centre, rolled, radius, held)
    walks = held.any(axis=0)
    on = np.concatenate([held, held[:1] if cyclic else held[-1:]])
    air = ~on & ~np.roll(on, 1, axis=0) & ~np.roll(on, -1, axis=0) | ~walks
    air &= driven
    return (
        max(0.0, -float(height[:, driven].min(initial=np.inf))),
        float(height[on].max(initial=-np.inf if walks.all() else 0.0)),
        float(np.linalg.norm(way, axis=-1).max()),
        float(height[air].min(initial=np.inf)),
    )


def _creep(centre: Array, rolled: Array, radius: Array, held: NDArray[np.bool_]) -> Array:
    """(n, n_F, 2) way of the contact points since each stance began, rolling taken out."""
    forth = (rolled[1:] @ rolled[:-1, :, 2, :, None])[..., 0]
    back = (rolled[:-1] @ rolled[1:, :, 2, :, None])[..., 0]
    creep = (centre[1:] - centre[:-1] - 0.5 * radius[:, None] * (forth - back))[..., :2]
    way = np.cumsum(np.where(held[..., None], creep, 0.0), axis=0)
    order = np.arange(len(held))[:, None]
    lifts = np.maximum.accumulate(np.where(held, -1, order), axis=0)  # the last time it was in the air
    begun = np.take_along_axis(way, np.maximum(lifts, 0)[..., None], axis=0)
    return np.asarray(way - np.where(lifts[..., None] >= 0, begun, 0.0))
