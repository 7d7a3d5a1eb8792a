"""Solve, look at the spline densely, and solve again with what was missed."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gaitforge.errors import UnsolvedError
from gaitforge.motion.causes import Cause, as_explain, causes_of, causes_of_misses
from gaitforge.motion.dense import DenseReport, check_densely
from gaitforge.motion.effort import effort_ratios
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.remedies import NEAR_M, Remedies, misses
from gaitforge.motion.segment import Segment
from gaitforge.motion.solvers.solution import Solution
from gaitforge.motion.solvers.structured import Structured
from gaitforge.motion.zmp import zero_moment_point

FEW_FEET = 4
"""Feet in stance up to which a push of the ground is not shared by many, but rocks the robot over a diagonal"""


def solve_refined(segment: Segment, options: MotionOptions) -> MotionPlan:
    """A plan whose spline keeps its bounds between samples too; `UnsolvedError` when none was found.

    Joint speeds, position limits and clearance are answered with rows and bounds, feet that the spline pushes
    into the ground or drags with a finer grid, and a problem without a solution with the next smaller
    stability share; the plan's `relaxed` and report say which.  The failure is that of the last share, and says
    who is in the way.
    """
    goal = _goal(segment, options)
    plan, failures = _over_shares(segment, goal, options.ground_tolerance)
    if plan is None and goal is not options and any(f.pushed for f in failures):
        plan = failures[0].nearly or _pushed(segment, options, goal.ground_tolerance)
    if plan is None:
        raise failures[-1].error
    return plan


class _Failure(NamedTuple):
    """Why a stability share has no plan."""

    error: UnsolvedError
    pushed: bool
    """Was a finer grid taken because of the ground?"""
    nearly: MotionPlan | None
    """The plan, before finer grids had none, that missed nothing but the tighter of two tolerances of the ground"""


def _goal(segment: Segment, options: MotionOptions) -> MotionOptions:
    """The options; for a transition between gaits that ever stands on few feet with its own tolerance of the ground."""
    grid = segment.grid
    walks = all(end is not None and end.base_velocity.any() for end in (grid.start, grid.end))
    tighter = options.change_tolerance < options.ground_tolerance
    if not (tighter and walks and int(grid.contact.sum(axis=1).min()) <= FEW_FEET):
        return options
    return replace(options, ground_tolerance=options.change_tolerance)


def _pushed(segment: Segment, options: MotionOptions, tolerance: float) -> MotionPlan | None:
    """A plan that keeps its feet out of the ground as well as a gait does, with what it missed of the tolerance."""
    plan, _ = _over_shares(segment, options, options.ground_tolerance)
    if plan is None:
        return None
    deep = plan.report.details["penetration_m"]
    report = replace(plan.report, details={**plan.report.details, "ground_tolerance_m": tolerance})
    told = (_in_the_ground(deep),) if deep > tolerance else ()
    return replace(plan, report=report, relaxed=tuple(dict.fromkeys((*plan.relaxed, *told))))


def _in_the_ground(deep: float) -> str:
    return f"feet {1e3 * deep:.1f} mm into the ground between samples"


def _over_shares(segment: Segment, options: MotionOptions, ground: float) -> tuple[MotionPlan | None, list[_Failure]]:
    """The plan of the first stability share that has one, and the failures of those before it."""
    failures: list[_Failure] = []
    for share in options.stability_shares:
        found = _refined(segment, replace(options, stability_share=share), ground)
        if isinstance(found, MotionPlan):
            relaxed = () if share == options.stability_shares[0] else (f"stability share {share:g}",)
            return replace(found, relaxed=(*found.relaxed, *relaxed)), failures
        failures.append(found)
    return None, failures


def _refined(segment: Segment, options: MotionOptions, ground: float) -> MotionPlan | _Failure:
    """Solve on the asked grid, then with what the dense check asks for; a plan that misses nothing but the ground,
    and that by less than `ground` [m], is remembered."""
    remedies = Remedies(_role_changes(segment))
    answered: tuple[str, ...] = ()
    start: Solution | None = None
    nearly: Callable[[], MotionPlan] | None = None

    def failure(error: UnsolvedError) -> _Failure:
        pushed = any("ground" in entry["for"] for entry in remedies.log)
        return _Failure(error, pushed, nearly() if nearly else None)

    bound = f"{options.refinements} refinements"
    for turn in range(options.refinements + 1):
        solution, plan = segment.solve(remedies.applied(options), remedies.families, start)
        remedies.record(answered, plan.report)
        if not solution.solved:
            return failure(_unsolved(segment, solution, turn, _in_the_way(segment, options, remedies, solution)))
        report = check_densely(segment.robot, plan, options.clearance + NEAR_M)
        missed, start = misses(segment, options, report), solution
        if not missed:
            return _reported(segment, plan, options, report, remedies)
        answered = tuple(m.family for m in missed)
        if nearly is None and set(answered) == {"ground"} and report.penetration <= ground:
            nearly = partial(_reported, segment, plan, options, report, remedies)
        if remedies.work >= options.iterations:
            bound = f"{options.iterations} iterations (motion.iterations)"
            break
        finer = _finer(segment, options, report)
        remedies.answer(segment, options, report)
        if finer > segment.grid.samples_per_column:
            remedies.move_to(finer, segment.grid.samples_per_column)
            segment, start = segment.on_grid(finer), None
    text = f"{segment.name}: after {bound} the spline still misses a bound: " + ", ".join(m.text for m in missed)
    explain = {"segment": segment.name, **as_explain(causes_of_misses(missed)), **report.as_dict()}
    return failure(UnsolvedError(text, explain))


def _finer(segment: Segment, options: MotionOptions, report: DenseReport) -> int:
    """Samples a column that ringing of the spline asks for: it falls with the interval about in proportion."""
    now = segment.grid.samples_per_column
    ratio = max(report.penetration / options.ground_tolerance, report.slip / options.slip_tolerance)
    return min(options.finest, int(np.ceil(now * ratio))) if ratio > 1.0 and now < options.finest else now


def _reported(
    segment: Segment, plan: MotionPlan, options: MotionOptions, report: DenseReport, remedies: Remedies
) -> MotionPlan:
    pressure = zero_moment_point(segment.robot, plan)
    efforts = effort_ratios(segment.robot, plan)
    details: dict[str, Any] = {
        "refinements": len(remedies.log) - 1,
        "refined": remedies.log,
        "samples_per_column": plan.samples_per_column,
        "stability_share": options.stability_share,
        **report.as_dict(),
        "ground_tolerance_m": options.ground_tolerance,
        "zmp_margin_m": float(pressure.margin.min()),
        "cop_margin_m": float(pressure.cop_margin.min()),
        "effort_ratio": max(efforts.values()),
        "effort_ratios": efforts,
    }
    spent = sum(entry["seconds"] for entry in remedies.log)
    turns = sum(entry["iterations"] for entry in remedies.log)
    done = replace(plan.report, seconds=spent, iterations=turns, details=details)
    return replace(plan, report=done, relaxed=_relaxed(options, report, pressure.margin, efforts))


def _relaxed(
    options: MotionOptions, report: DenseReport, margin: NDArray[np.float64], efforts: Mapping[str, float]
) -> tuple[str, ...]:
    """What the spline does not keep and refinement has no answer to, in words."""
    told = []
    if report.penetration > options.ground_tolerance:
        told.append(_in_the_ground(report.penetration))
    if report.slip > options.slip_tolerance:
        told.append(f"feet slip {1e3 * report.slip:.1f} mm in a stance")
    if margin.min() < 0.0:
        told.append(f"zero-moment point {-1e3 * margin.min():.1f} mm outside the support polygon")
    weakest = max(efforts, key=efforts.__getitem__)
    if efforts[weakest] > 1.0:
        told.append(f"limb {weakest} at {efforts[weakest]:.2f} of its effort limit")
    return tuple(told)


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


def _in_the_way(segment: Segment, options: MotionOptions, remedies: Remedies, failed: Solution) -> list[Cause]:
    """What the least violated point says, which is looked for only on request if the solver has not."""
    violations = failed.violations
    if violations is None and options.explain:
        problem, _ = segment.build(remedies.applied(options), remedies.families)
        violations = Structured().nearest(problem).violations
    return causes_of(segment, violations or ())


def _unsolved(segment: Segment, solution: Solution, turn: int, causes: Sequence[Cause]) -> UnsolvedError:
    family, (value, where, unit) = max(
        solution.worst.items(), key=lambda item: item[1][0], default=("nothing", (0.0, "", ""))
    )
    when = "" if not turn else f" in refinement {turn}"
    message = f"{segment.name}: {solution.status}{when} after {solution.iterations} iterations"
    explain = {
        "segment": segment.name, "status": solution.status, "families": [family], "where": str(where),
        "value": value, "unit": unit, "advice": "walk slower, lower the steps, or try another pattern",
    }  # fmt: skip
    if not causes:
        return UnsolvedError(f"{message}; worst is {family} at {where}, off by {value:.2g} {unit}", explain)
    told = as_explain(causes)
    return UnsolvedError(f"{message}; {told['text']}", {**explain, **told})
