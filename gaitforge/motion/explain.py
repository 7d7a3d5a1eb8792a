"""What would help a segment that has no plan: changes that its causes suggest, tried for whether they do."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from gaitforge.errors import UnsolvedError
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.refine import solve_refined
from gaitforge.motion.segment import Segment, step_height
from gaitforge.motion.solvers.structured import Structured
from gaitforge.motion.trajectory import Discretisation

PROBE = Structured(max_iterations=40, patience=12, restoration=False, fallback=None)
"""The solver of what is tried: an answer soon, or none"""
PROBE_TURNS = 3
"""Refinements of what is probed"""
HIGH_STEPS = {"joint_speed", "kinematics", "clearance"}
"""Families that lower steps leave more room"""
SHORT_TIME = {"joint_speed", "balance", "progress"}
"""Families that a longer cycle leaves more room"""


def explained(segment: Segment, options: MotionOptions, failure: UnsolvedError) -> UnsolvedError:
    """The failure, with what was probed and what of it has a plan."""
    shares = options.stability_shares[-1:]
    quick = replace(options, solver=PROBE, stability_shares=shares, explain=False, refinements=PROBE_TURNS)
    probed = list(_probed(segment, quick, set(failure.explain.get("families", ()))))
    helped = [what for what, works in probed if works]
    advice = "has a plan with " + ", or with ".join(helped) if helped else failure.explain["advice"]
    tried = [{"what": what, "has_a_plan": works} for what, works in probed]
    return UnsolvedError(f"{failure.message}; {advice}", {**failure.explain, "probed": tried, "advice": advice})


def _probed(segment: Segment, options: MotionOptions, families: set[str]) -> Iterator[tuple[str, bool]]:
    """(what was changed, whether there is a checked plan then): slower, lower steps, more time."""
    grid, command = segment.grid, segment.grid.command

    def solved(changed: Discretisation) -> bool:
        try:
            solve_refined(replace(segment, grid=changed), options)
        except UnsolvedError:
            return False
        return True

    if segment.kind == "gait" and (command.speed or command.yaw_rate):
        works = True
        for share in (0.5, 0.75, 0.25):  # the faster of two that have a plan, or the slowest
            if share != 0.5 and works != (share == 0.75):
                continue
            slower = replace(command, speed=share * command.speed, yaw_rate=share * command.yaw_rate)
            done = solved(replace(grid, command=slower))
            works = done if share == 0.5 else works
            turn = f" and {slower.yaw_rate:.3g} rad/s" if command.yaw_rate else ""
            yield f"{slower.speed:.3g} m/s{turn}", done
    if families & HIGH_STEPS:
        height = step_height(segment.robot, command, options)
        lower = replace(command, step_height=0.5 * height)
        yield f"steps of {500 * height:.0f} mm", solved(replace(grid, command=lower))
    if families & SHORT_TIME:
        longer = replace(grid, duration=1.5 * grid.duration)
        yield f"{longer.duration:.3g} s instead of {grid.duration:.3g} s", solved(longer)
