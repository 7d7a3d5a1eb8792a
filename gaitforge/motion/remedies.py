"""What the dense check found missed, and what is added to the motion problem for it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from gaitforge.motion.bodies import BASE, Closest, LimbCapsule
from gaitforge.motion.constraints.clearance import Clearance
from gaitforge.motion.constraints.joint_speed import JointSpeed
from gaitforge.motion.constraints.limb_height import LimbHeight
from gaitforge.motion.constraints.trunk_height import TrunkHeight
from gaitforge.motion.dense import DenseReport
from gaitforge.motion.family import Family
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.report import SolveReport
from gaitforge.motion.segment import Segment
from gaitforge.motion.shins import LowPoint
from gaitforge.motion.trunk import trunk_corners

NEAR_M = 0.01
"""[m] pairs of bodies this much farther apart than the clearance are watched, too"""
KEPT = 0.5
"""Share of the clearance that the spline has to keep; bodies that come nearer are parted by all of it"""
ALIKE = 4
"""Pairs of bodies of two limbs that are kept apart at one sample"""
TRUNK_M = 0.005
"""[m] that the trunk's corners keep above the ground at samples, where the spline took them below it"""
INSIDE_RAD = 2e-3
"""[rad] by how much more than the excess the samples keep from a position limit"""


@dataclass(frozen=True)
class Miss:
    """One promise of the samples that the spline does not keep."""

    family: str
    limb: str
    value: float
    unit: str
    text: str


@dataclass
class Remedies:
    """What refinement has added so far, and what each turn of it cost."""

    shares: dict[int, float] = field(default_factory=dict)
    """limb → share of its joint speed limits that a whole interval may use"""
    clearances: list[Clearance] = field(default_factory=list)
    trunk: list[TrunkHeight] = field(default_factory=list)
    low: dict[tuple[int, int, tuple[float, float, float]], LowPoint] = field(default_factory=dict)
    """Points of limbs that were found in the ground, or near it beside such"""
    joint_margin: float = 0.0
    """[rad] kept from position limits on top of the option"""
    log: list[dict[str, Any]] = field(default_factory=list)

    @property
    def families(self) -> list[Family]:
        """Constraint families to be added to the problem."""
        speeds = (JointSpeed(share, (i,)) for i, share in self.shares.items())
        shins = [LimbHeight(tuple(self.low.values()))] if self.low else []
        return [*speeds, *self.clearances, *self.trunk, *shins]

    def applied(self, options: MotionOptions) -> MotionOptions:
        """The options with what has been tightened."""
        return replace(options, joint_margin=options.joint_margin + self.joint_margin)

    def record(self, answered: Iterable[str], report: SolveReport) -> None:
        """Note one solve, and which families it answers (none: the first)."""
        size = {key: report.details[key] for key in ("rows", "variables")}
        done = {"iterations": report.iterations, "seconds": round(report.seconds, 5)}
        self.log.append({"for": sorted(set(answered)), **size, **done})

    @property
    def work(self) -> float:
        """Iterations so far, one on a finer grid counted as many times as there are more variables."""
        return float(sum(e["iterations"] * e["variables"] for e in self.log) / self.log[0]["variables"])

    def move_to(self, finer: int, before: int) -> None:
        """Ask for the same clearances at the nearest samples of another grid, given in samples a column."""
        self.clearances = [
            replace(c, pairs=tuple(p._replace(sample=round(p.sample * finer / before)) for p in c.pairs))
            for c in self.clearances
        ]

    def answer(self, segment: Segment, options: MotionOptions, report: DenseReport) -> None:
        """Add what helps against joint speeds, position limits, a trunk in the ground and bodies too close."""
        robot = segment.robot
        for i in segment.moving:
            ratio = float(report.speed_ratio[robot.joint_indices(robot.limbs[i])].max())
            if ratio > options.speed_share:
                before = self.shares.get(i, options.speed_share)
                self.shares[i] = before * min(0.95, 0.98 * options.speed_share / ratio)
        beyond = float(report.limit_excess.max())
        if beyond > 0.0:
            self.joint_margin += beyond + INSIDE_RAD
        if report.trunk_height < 0.0:
            corners = tuple((float(x), float(y), float(z)) for x, y, z in trunk_corners(robot))
            self.trunk = [TrunkHeight(corners, TRUNK_M)]
        sunk = {point.limb for point in low_free(segment, report) if point.height < 0.0}
        self.low |= {(p.limb, p.joint, p.point): p for p in low_free(segment, report) if p.limb in sunk}
        close = bodies_free(segment, report)
        if min((c.gap for c in close), default=np.inf) < KEPT * options.clearance:
            given = _given_gaps(segment, report)
            pairs = (_asked(c, given.get((c.first, c.second), np.inf), options.clearance) for c in _nearest(close))
            self.clearances.append(Clearance(tuple(pairs), options.clearance))


def misses(segment: Segment, options: MotionOptions, report: DenseReport) -> list[Miss]:
    """What the spline misses between samples, the ground only where a finer grid may still be taken."""
    found, robot = [], segment.robot
    finer = segment.grid.samples_per_column < options.finest
    if finer and report.penetration > options.ground_tolerance:
        deep = f"a foot {report.penetration * 1e3:.1f} mm in the ground"
        found.append(Miss("ground", "", report.penetration, "m", deep))
    if finer and report.slip > options.slip_tolerance:
        found.append(Miss("slip", "", report.slip, "m", f"a foot slips {report.slip * 1e3:.1f} mm in a stance"))
    fast = int(np.argmax(report.speed_ratio))
    if report.speed_ratio[fast] > options.speed_share:
        share, name = float(report.speed_ratio[fast]), robot.joint_names[fast]
        found.append(
            Miss("joint_speed", _limb_of(segment, fast), share, "", f"{name} at {share:.2f} of its speed limit")
        )
    far = int(np.argmax(report.limit_excess))
    if report.limit_excess[far] > 0.0:
        excess, name = float(report.limit_excess[far]), robot.joint_names[far]
        text = f"{name} {excess:.3f} rad beyond its position limit"
        found.append(Miss("joint_limits", _limb_of(segment, far), excess, "rad", text))
    if report.trunk_height < 0.0:
        text = f"the trunk {-1e3 * report.trunk_height:.0f} mm in the ground"
        found.append(Miss("trunk_height", "", report.trunk_height, "m", text))
    lowest = min(low_free(segment, report), key=lambda p: p.height, default=None)
    if lowest is not None and lowest.height < 0.0:
        name = robot.limbs[lowest.limb].name
        text = f"{name} {-1e3 * lowest.height:.0f} mm in the ground beside its foot"
        found.append(Miss("limb_height", name, lowest.height, "m", text))
    pair = min(bodies_free(segment, report), key=lambda c: c.gap, default=None)
    if pair is not None and pair.gap < KEPT * options.clearance:
        text = f"{pair.first.name} {pair.gap * 1e3:.0f} mm from {pair.second.name}"
        found.append(Miss("clearance", _owner(segment, pair), pair.gap, "m", text))
    return found


def bodies_free(segment: Segment, report: DenseReport) -> list[Closest]:
    """Pairs of bodies that this segment can part: not those in the states that its neighbours have fixed."""
    return [c for c in report.close if not _given(segment, c) and _moves(segment, c)]


def low_free(segment: Segment, report: DenseReport) -> list[LowPoint]:
    """Low points of limbs that this segment moves."""
    return [p for p in report.low if p.limb in segment.moving]


def _nearest(close: list[Closest]) -> tuple[Closest, ...]:
    """The few nearest of every two limbs at every sample: bodies side by side say the same."""
    kept: dict[tuple[int, int, int], list[Closest]] = {}
    for pair in sorted(close, key=lambda c: c.gap):
        alike = kept.setdefault((pair.sample, pair.first.limb, pair.second.limb), [])
        if len(alike) < ALIKE:
            alike.append(pair)
    return tuple(pair for alike in kept.values() for pair in alike)


def _given_gaps(segment: Segment, report: DenseReport) -> dict[tuple[LimbCapsule, LimbCapsule], float]:
    """[m] of two bodies in the states that neighbours have fixed."""
    gaps: dict[tuple[LimbCapsule, LimbCapsule], float] = {}
    for c in (c for c in report.close if _given(segment, c)):
        gaps[c.first, c.second] = min(c.gap + c.dip, gaps.get((c.first, c.second), np.inf))
    return gaps


def _asked(pair: Closest, given: float, clearance: float) -> Closest:
    """The pair, asked for less than the clearance where it keeps enough as it is, or neighbours left it `given` [m].

    Feet that stand cannot part: between them more than what they have where they were put has no solution.
    """
    kept = pair.gap + pair.dip if pair.gap >= KEPT * clearance else np.inf
    least = max(min(given, kept), KEPT * clearance + pair.dip)
    return pair._replace(less=max(0.0, clearance + pair.dip - least))


def _moves(segment: Segment, pair: Closest) -> bool:
    return any(c.limb in segment.moving for c in (pair.first, pair.second))


def _given(segment: Segment, pair: Closest) -> bool:
    grid = segment.grid
    first = grid.start is not None and not grid.start.rest and pair.sample == 0
    last = grid.end is not None and not grid.end.rest and pair.sample == grid.intervals
    return first or last


def _owner(segment: Segment, pair: Closest) -> str:
    names = segment.robot.limb_names
    return "+".join(names[c.limb] for c in (pair.first, pair.second) if c.limb != BASE)


def _limb_of(segment: Segment, row: int) -> str:
    name = segment.robot.joint_names[row]
    return next((limb.name for limb in segment.robot.limbs if name in limb.joints), "")
