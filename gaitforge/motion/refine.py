"""Solve, look at the spline densely, and solve again with what was missed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gaitforge.errors import UnsolvedError
from gaitforge.motion.constraints.clearance import Clearance
from gaitforge.motion.constraints.joint_speed import JointSpeed
from gaitforge.motion.dense import DenseReport, check_densely
from gaitforge.motion.family import Family
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.segment import Segment
from gaitforge.motion.solvers.solution import Solution


def solve_refined(segment: Segment, options: MotionOptions) -> MotionPlan:
    """A plan whose spline keeps the bounds between samples too; `UnsolvedError` when none was found."""
    extra: list[Family] = []
    start, shares, seconds, iterations = None, {}, 0.0, 0
    for turn in range(options.refinements + 1):
        solution, plan = segment.solve(options, extra, start)
        seconds, iterations = seconds + plan.report.seconds, iterations + solution.iterations
        if not solution.solved:
            raise _unsolved(segment, solution, turn)
        report = check_densely(segment.robot, plan, options.clearance + 0.01)
        more = _remedies(segment, options, report, shares)
        if not more:
            details = {"refinements": turn, **report.as_dict(), "rows": len(solution.worst)}
            done = replace(plan.report, seconds=seconds, iterations=iterations, details=details)
            return replace(plan, report=done)
        extra, start = [*(f for f in extra if not isinstance(f, JointSpeed)), *more], solution.x
    raise UnsolvedError(
        f"{segment.name}: after {options.refinements} refinements the spline still misses a bound: {_missed(report)}",
        {"segment": segment.name, "families": [f.name for f in more], **report.as_dict()},
    )


def _remedies(
    segment: Segment, options: MotionOptions, report: DenseReport, shares: dict[int, float]
) -> list[Family]:
    """Families to add: nothing when the spline keeps what the samples promise."""
    more: list[Family] = []
    robot = segment.robot
    slow = False
    for i in segment.moving:
        ratio = float(report.speed_ratio[robot.joint_indices(robot.limbs[i])].max())
        if ratio > options.speed_share:
            shares[i] = shares.get(i, options.speed_share) * min(0.95, 0.98 * options.speed_share / ratio)
            slow = True
    if slow:
        more += [JointSpeed(share, (i,)) for i, share in shares.items()]
    if report.gap < 0.5 * options.clearance:
        near = tuple(c for c in report.close if c.gap < options.clearance + 0.01)
        more.append(Clearance(near, options.clearance))
        if not slow:
            more += [JointSpeed(share, (i,)) for i, share in shares.items()]
    return more


def _missed(report: DenseReport) -> str:
    fast, gap = float(np.max(report.speed_ratio)), report.gap
    parts = [f"joint speed at {fast:.2f} of its limit"] if fast > 1 else []
    if gap < 0:
        pair = min(report.close, key=lambda c: c.gap)
        parts.append(f"{pair.first.name} {-gap * 1e3:.0f} mm into {pair.second.name}")
    return ", ".join(parts) or "margins only"


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
