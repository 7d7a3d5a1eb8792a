"""Why a segment has no plan: who resists, when and by how much, and what would help.

A certificate (`limits`) is a proof and comes first.  Without one, the least violated point says which rows are
in the way, and a few changes are tried for whether they help, so that advice is more than a guess.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from gaitforge.errors import UnsolvedError
from gaitforge.motion.constraints.joint_speed import JointSpeed
from gaitforge.motion.elastic import Violation, least_violation
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.refine import solve_refined
from gaitforge.motion.segment import Segment, step_height
from gaitforge.motion.solvers.structured import Structured
from gaitforge.motion.trajectory import Discretisation

MOST = 6
"""Causes that are told"""
PROBE = Structured(max_iterations=40, patience=12, fallback=None)
"""The solver of what is tried: an answer soon, or none"""
PROBE_TURNS = 3
"""Refinements of what is probed"""
SPEEDS = (0.75, 0.5, 0.25)


@dataclass(frozen=True)
class Cause:
    """One family and limb that resist, where they resist most."""

    family: str
    limb: str
    sample: int | None
    time: float | None
    """[s] from the beginning of the segment"""
    by: float
    unit: str
    text: str
    advice: str

    def as_dict(self) -> dict[str, Any]:
        """For ``summary.json``."""
        when = None if self.time is None else round(self.time, 4)
        return {
            "family": self.family, "limb": self.limb, "sample": self.sample, "time_s": when, "by": self.by,
            "unit": self.unit, "text": self.text,
        }  # fmt: skip


def explained(
    segment: Segment, options: MotionOptions, failure: UnsolvedError, shares: Mapping[int, float]
) -> UnsolvedError:
    """The failure of a segment, with who resists, where, by how much, and what would help; `shares` as in `explain`."""
    why = explain(segment, options, shares)
    known = {key: value for key, value in why.items() if value}
    message = f"{failure.message}; {why['text']}; {why['advice']}" if why["causes"] else failure.message
    return UnsolvedError(message, {**failure.explain, **known})


def explain(segment: Segment, options: MotionOptions, shares: Mapping[int, float] | None = None) -> dict[str, Any]:
    """The ``explain`` entry of a segment that has no plan: families, limbs, causes, text, advice and what was probed.

    Joint speeds, which refinement would add, are asked for from the start, by limb the `shares` of their limits that
    refinement had come to; the smallest stability share counts.
    """
    asked = replace(options, stability_share=min(options.stability_shares), table=False)
    known = shares or {}
    speeds = [JointSpeed(known.get(i, options.speed_share), (i,)) for i in segment.moving]
    problem, _ = segment.build(asked, speeds)
    _, violations = least_violation(problem)
    causes = _causes(segment, violations)
    probed = list(_probed(segment, asked))
    helped = [what for what, works in probed if works]
    return {
        "segment": segment.name,
        "families": list(dict.fromkeys(c.family for c in causes)),
        "limbs": list(dict.fromkeys(name for c in causes for name in c.limb.split("+") if name)),
        "causes": [c.as_dict() for c in causes],
        "text": "; ".join(c.text for c in causes[:3]),
        "probed": [{"what": what, "has_a_plan": works} for what, works in probed],
        "advice": _advice(causes, helped),
    }


def _causes(segment: Segment, violations: Sequence[Violation]) -> list[Cause]:
    """The worst violation of every family and limb, the worst first."""
    worst: dict[tuple[str, str], Violation] = {}
    for violation in violations:
        name, _ = _place(violation.label)
        worst.setdefault((violation.family, name), violation)
    return [_cause(segment, name, violation) for (_, name), violation in list(worst.items())[:MOST]]


def _place(label: Any) -> tuple[str, int | None]:
    """(limb or what is spoken of, sample) of a row's label."""
    if isinstance(label, tuple):
        return str(label[0]), int(label[1])
    return ("", int(label)) if isinstance(label, int) else (str(label).split(" at sample")[0], None)


def _cause(segment: Segment, name: str, violation: Violation) -> Cause:
    _, sample = _place(violation.label)
    time = None if sample is None else sample * segment.grid.dt
    when = "" if time is None else f" at {time:.2f} s"
    text, advice = _words(segment, name, sample, violation)
    by = abs(violation.amount)
    return Cause(violation.family, name, sample, time, by, violation.unit, f"{text}{when}", advice)


def _words(segment: Segment, name: str, sample: int | None, violation: Violation) -> tuple[str, str]:
    """What the row means and what helps against it."""
    family, amount = violation.family, violation.amount
    far = f"{1e3 * abs(amount):.0f} mm"
    if family == "kinematics":
        return _foot(segment, name, sample, violation)
    if family == "balance":
        feet = name.replace("+", ", ")
        if violation.component == 2:
            return f"the feet {feet} carry too much or too little of the weight", "take more time"
        return (
            f"the centre of pressure is {far} outside what {feet} hold",
            "another pattern with more feet on the ground, a longer cycle, or a smaller motion.stability_shares",
        )
    if family == "rolling":
        return f"the foot of {name} slips {far}", "shorter steps: walk slower, or with a shorter cycle"
    if family == "joint_speed":
        return f"a joint of {name} turns {abs(amount):.2f} rad too far in an interval", "walk slower, or take more time"
    if family == "progress":
        return f"the body is {far} short of the commanded way", "more time a column, or a slower gait"
    if family == "clearance":
        return f"{name} come too near to each other", "another pattern, a wider posture, or shorter steps"
    if family == "trunk_height":
        return f"the trunk is {far} in the ground", "raise the body, or tilt it less"
    if family == "effort":
        return (
            f"a joint of {name} would need {abs(amount):.2f} of its effort limit more than is allowed",
            "a lighter load, another posture, or more feet on the ground",
        )
    return f"{family} of {name or 'the body'} is off by {abs(amount):.3g} {violation.unit}", f"relax {family}"


def _foot(segment: Segment, name: str, sample: int | None, violation: Violation) -> tuple[str, str]:
    """FK − e + s = 0: where the joints can bring the foot, against where it has to be."""
    far, index = f"{1e3 * abs(violation.amount):.0f} mm", segment.robot.limb_names.index(name)
    standing = sample is not None and bool(segment.grid.ground[sample % segment.grid.samples, index])
    if violation.component == 2 and standing:
        if violation.amount < 0.0:
            return f"the foot of {name} stays {far} above the ground", "lower the body, or walk slower"
        return f"the foot of {name} is pushed {far} into the ground", "raise the body"
    if violation.component == 2:
        return f"the foot of {name} is lifted {far} too little", "lower the steps, or raise the body less"
    where = "where it stands" if standing else "on its way"
    return f"the foot of {name} is {far} short of its place {where}", "shorter steps: walk slower, or a shorter cycle"


def _probed(segment: Segment, options: MotionOptions) -> Iterator[tuple[str, bool]]:
    """(what was changed, whether there is a checked plan then): slower until there is, lower steps, more time."""
    grid, command = segment.grid, segment.grid.command
    shares = (options.stability_share,)
    quick = replace(options, solver=PROBE, stability_shares=shares, explain=False, refinements=PROBE_TURNS)

    def solved(changed: Discretisation) -> bool:
        try:
            solve_refined(replace(segment, grid=changed), quick)
        except UnsolvedError:
            return False
        return True

    if segment.kind == "gait" and (command.speed or command.yaw_rate):
        for share in SPEEDS:
            slower = replace(command, speed=share * command.speed, yaw_rate=share * command.yaw_rate)
            works = solved(replace(grid, command=slower))
            turn = f" and {slower.yaw_rate:.3g} rad/s" if command.yaw_rate else ""
            yield f"{slower.speed:.3g} m/s{turn}", works
            if works:
                break
    height = step_height(segment.robot, command, options)
    lower = replace(command, step_height=0.5 * height)
    yield f"steps of {500 * height:.0f} mm", solved(replace(grid, command=lower))
    longer = replace(grid, duration=1.5 * grid.duration)
    yield f"{longer.duration:.3g} s instead of {grid.duration:.3g} s", solved(longer)


def _advice(causes: Sequence[Cause], helped: Sequence[str]) -> str:
    """What was probed and is solved; else what the causes suggest."""
    if helped:
        return "has a plan with " + ", or with ".join(helped)
    told = dict.fromkeys(c.advice for c in causes[:3])
    return "; ".join(told) or "try another pattern, or a longer cycle"
