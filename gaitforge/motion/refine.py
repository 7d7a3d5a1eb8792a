"""Solve, look at the spline densely, and solve again with what was missed."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from gaitforge.errors import UnsolvedError
from gaitforge.motion.bodies import Closest
from gaitforge.motion.constraints.clearance import Clearance
from gaitforge.motion.constraints.joint_speed import JointSpeed
from gaitforge.motion.dense import DenseReport, check_densely
from gaitforge.motion.effort import effort_ratios
from gaitforge.motion.family import Family
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.segment import Segment
from gaitforge.motion.solvers.solution import Solution
from gaitforge.motion.zmp import zero_moment_point

NEAR_M = 0.01
"""[m] pairs of bodies this much farther apart than the clearance are watched, too"""


@dataclass
class _Remedies:
    """What refinement has added so far."""

    shares: dict[int, float] = field(default_factory=dict)
    """limb → share of its joint speed limits that a whole interval may use"""
    clearances: list[Clearance] = field(default_factory=list)
    turns: int = 0
    iterations: int = 0
    seconds: float = 0.0

    @property
    def families(self) -> list[Family]:
        return [*(JointSpeed(share, (i,)) for i, share in self.shares.items()), *self.clearances]


def solve_refined(segment: Segment, options: MotionOptions) -> MotionPlan:
    """A plan whose spline keeps its bounds between samples too; `UnsolvedError` when none was found.

    Joint speeds and clearance are answered with rows, feet pushed into the ground with a finer grid,
    and a problem without a solution with the next smaller stability share; the plan's `relaxed` and
    report say which.
    """
    failure: UnsolvedError | None = None
    for share in options.stability_shares:
        try:
            plan = _finer(segment, replace(options, stability_share=share))
        except UnsolvedError as error:
            failure = failure or error
            continue
        relaxed = () if share == options.stability_shares[0] else (f"stability share {share:g}",)
        return replace(plan, relaxed=(*plan.relaxed, *relaxed))
    assert failure is not None
    raise failure


def _finer(segment: Segment, options: MotionOptions) -> MotionPlan:
    """Solve on the asked grid; when the spline pushes feet into the ground, on one that is as fine as needed."""
    remedies = _Remedies(_role_changes(segment))
    start: NDArray[np.float64] | None = None
    for turn in range(options.refinements + 1):
        solution, plan = segment.solve(options, remedies.families, start)
        remedies.seconds += plan.report.seconds
        remedies.iterations += solution.iterations
        if not solution.solved:
            raise _unsolved(segment, solution, turn)
        report = check_densely(segment.robot, plan, options.clearance + NEAR_M)
        now, start = segment.grid.samples_per_column, solution.x
        if report.penetration > options.ground_tolerance and now < options.finest:
            finer = min(options.finest, int(np.ceil(now * report.penetration / options.ground_tolerance)))
            segment, start = segment.on_grid(finer), None
            remedies.clearances.clear()  # their samples are another grid's
        elif not _remedy(segment, options, report, remedies):
            return _reported(segment, plan, options, report, remedies)
        remedies.turns += 1
    missed = _missed(segment, options, report)
    raise UnsolvedError(
        f"{segment.name}: after {options.refinements} refinements the spline still misses a bound: "
        + ", ".join(missed.values()),
        {
            "segment": segment.name,
            "families": sorted(missed),
            "advice": "walk slower, take more time, or choose another pattern or posture",
            **report.as_dict(),
        },
    )


def _reported(
    segment: Segment, plan: MotionPlan, options: MotionOptions, report: DenseReport, remedies: _Remedies
) -> MotionPlan:
    efforts = effort_ratios(segment.robot, plan)
    details = {
        "refinements": remedies.turns,
        "samples_per_column": plan.samples_per_column,
        "stability_share": options.stability_share,
        **report.as_dict(),
        "zmp_margin_m": float(zero_moment_point(segment.robot, plan).margin.min()),
        "effort_ratio": max(efforts.values()),
        "effort_ratios": efforts,
    }
    done = replace(plan.report, seconds=remedies.seconds, iterations=remedies.iterations, details=details)
    deep = report.penetration
    relaxed = (f"feet {1e3 * deep:.1f} mm into the ground between samples",) if deep > options.ground_tolerance else ()
    return replace(plan, report=done, relaxed=relaxed)


def _role_changes(segment: Segment) -> dict[int, float]:
    """Limbs that change their posture for good get their speed bound from the start."""
    grid = segment.grid
    if grid.cyclic or grid.start is None or grid.end is None or grid.start.rest or grid.end.rest:
        return {}
    shares = {}
    for i in segment.moving:
        rows = segment.robot.joint_indices(segment.robot.limbs[i])
        if np.abs(grid.start.joints[rows] - grid.end.joints[rows]).max() > 0.5:
            shares[i] = 0.75
    return shares


def _remedy(segment: Segment, options: MotionOptions, report: DenseReport, remedies: _Remedies) -> bool:
    """Add what helps; False when nothing is needed."""
    robot, needed = segment.robot, False
    for i in segment.moving:
        ratio = float(report.speed_ratio[robot.joint_indices(robot.limbs[i])].max())
        if ratio > options.speed_share:
            before = remedies.shares.get(i, options.speed_share)
            remedies.shares[i] = before * min(0.95, 0.98 * options.speed_share / ratio)
            needed = True
    close = [c for c in report.close if not _given(segment, c)]
    if min((c.gap for c in close), default=np.inf) < 0.5 * options.clearance:
        near = tuple(c for c in close if c.gap < options.clearance + NEAR_M)
        remedies.clearances.append(Clearance(near, options.clearance))
        needed = True
    return needed


def _given(segment: Segment, pair: Closest) -> bool:
    """Is the sample one that the neighbouring segments have fixed?"""
    grid = segment.grid
    first = grid.start is not None and not grid.start.rest and pair.sample == 0
    last = grid.end is not None and not grid.end.rest and pair.sample == grid.intervals
    return first or last


def _missed(segment: Segment, options: MotionOptions, report: DenseReport) -> dict[str, str]:
    """Family → in words by how much the spline misses it."""
    missed = {}
    if report.penetration > options.ground_tolerance and segment.grid.samples_per_column < options.finest:
        missed["ground"] = f"a foot {report.penetration * 1e3:.1f} mm in the ground"
    fast = int(np.argmax(report.speed_ratio))
    if report.speed_ratio[fast] > options.speed_share:
        name = segment.robot.joint_names[fast]
        missed["joint_speed"] = f"{name} at {report.speed_ratio[fast]:.2f} of its speed limit"
    close = [c for c in report.close if not _given(segment, c)]
    pair = min(close, key=lambda c: c.gap, default=None)
    if pair is not None and pair.gap < 0.5 * options.clearance:
        missed["clearance"] = f"{pair.first.name} {pair.gap * 1e3:.0f} mm from {pair.second.name}"
    return missed


def _unsolved(segment: Segment, solution: Solution, turn: int) -> UnsolvedError:
    family, (value, where, unit) = max(
        solution.worst.items(), key=lambda item: item[1][0], default=("nothing", (0.0, "", ""))
    )
    when = "" if not turn else f" in refinement {turn}"
    return UnsolvedError(
        f"{segment.name}: {solution.status}{when} after {solution.iterations} iterations; "
        f"worst is {family} at {where}, off by {value:.2g} {unit}",
        {
            "segment": segment.name,
            "status": solution.status,
            "families": [family],
            "where": str(where),
            "value": value,
            "unit": unit,
            "advice": "walk slower, lower the steps, or try another pattern",
        },
    )
