"""What the spline does between the samples, seen densely: the promises of the samples, measured."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.bodies import Closest, closest_pairs, housings, limb_capsules
from gaitforge.motion.plan import MotionPlan
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

    @property
    def gap(self) -> float:
        """[m] smallest gap among `close` (inf when nothing is close)."""
        return min((c.gap for c in self.close), default=float("inf"))

    def as_dict(self) -> dict[str, float]:
        """For the summary: plain numbers."""
        return {
            "speed_ratio": float(self.speed_ratio.max()),
            "limit_excess_rad": float(self.limit_excess.max()),
            "penetration_m": self.penetration,
            "lift_m": self.lift,
            "slip_m": self.slip,
            "swing_clearance_m": self.swing_clearance,
            "gap_m": self.gap,
            "trunk_height_m": self.trunk_height,
        }


def check_densely(robot: RobotModel, plan: MotionPlan, margin: float, per_interval: int = 4) -> DenseReport:
    """Sample the splines of a plan `per_interval` times an interval and measure; `margin` [m] between bodies."""
    intervals = len(plan.times) - 1
    times = np.linspace(0.0, plan.duration, intervals * per_interval + 1)
    joints, rates = plan.joint_spline(times), plan.joint_spline(times, 1)
    base = plan.base_spline(times)
    poses = evaluate_limbs(robot, joints)
    turns = matrices(base[:, 3:6])
    held = np.repeat(plan.pattern.contact.T, plan.samples_per_column * per_interval, axis=0)
    worst = [_foot(robot, i, poses[i], turns, base, held[:, i], plan.pattern.cyclic) for i in poses]
    deep, lift, slip, clear = (np.array(v) for v in zip(*worst, strict=True))
    beside = housings(robot)
    near = closest_pairs(limb_capsules(robot), poses, margin, per_interval)
    close = [c for c in near if (c.first, c.second) not in beside]
    close += closest_to_trunk(robot, poses, margin, per_interval)
    return DenseReport(
        speed_ratio=np.abs(rates).max(axis=0) / robot.velocity,
        limit_excess=np.maximum(joints - robot.upper, robot.lower - joints).max(axis=0),
        penetration=float(deep.max()),
        lift=float(lift.max()),
        slip=float(slip.max()),
        swing_clearance=float(clear.min()),
        trunk_height=trunk_height(robot, base),
        close=tuple(close),
    )


def _foot(
    robot: RobotModel, limb: int, pose: LimbPoses, turns: Array, base: Array, held: NDArray[np.bool_], cyclic: bool
) -> tuple[float, float, float, float]:
    """Penetration, lift in stance, slip in a stance, mid-swing clearance of one foot."""
    radius = robot.limbs[limb].foot.radius
    centre = base[:, :3] + np.einsum("nij,nj->ni", turns, pose.foot)
    height = centre[:, 2] - radius
    on = np.append(held, held[0] if cyclic else held[-1])
    if not held.any():
        return float(max(0.0, -height.min())), 0.0, 0.0, float(height.min())
    rolled = turns @ pose.rotation
    forth = np.einsum("nij,nj->ni", rolled[1:], rolled[:-1, 2])
    back = np.einsum("nij,nj->ni", rolled[:-1], rolled[1:, 2])
    creep = (centre[1:] - centre[:-1] - radius * 0.5 * (forth - back))[:, :2]
    way = np.cumsum(np.where(held[:, None], creep, 0.0), axis=0)
    lifts = np.maximum.accumulate(np.where(held, -1, np.arange(len(held))))  # the last time it was in the air
    begun = np.where(lifts[:, None] >= 0, way[lifts], 0.0)
    slip = float(np.linalg.norm(way - begun, axis=1).max())
    air = ~on & ~np.roll(on, 1) & ~np.roll(on, -1)
    clear = float(height[air].min()) if air.any() else float("inf")
    return float(max(0.0, -height.min())), float(height[on].max()), slip, clear
