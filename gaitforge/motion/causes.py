"""Who is in the way of a plan: family, limb, sample and amount, in words."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from gaitforge.motion.remedies import Miss
from gaitforge.motion.segment import Segment
from gaitforge.motion.solvers.elastic import Violation

MOST = 6
"""Causes that are told"""


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


def causes_of(segment: Segment, violations: Sequence[Violation]) -> list[Cause]:
    """The worst violation of every family and limb, the worst first."""
    worst: dict[tuple[str, str], Violation] = {}
    for violation in violations:
        name, _ = _place(violation.label)
        worst.setdefault((violation.family, name), violation)
    return [_cause(segment, name, violation) for (_, name), violation in list(worst.items())[:MOST]]


def causes_of_misses(missed: Iterable[Miss]) -> list[Cause]:
    """What the spline still misses after the last refinement."""
    advice = "walk slower, take more time, or choose another pattern or posture"
    return [Cause(m.family, m.limb, None, None, abs(m.value), m.unit, m.text, advice) for m in list(missed)[:MOST]]


def as_explain(causes: Sequence[Cause]) -> dict[str, Any]:
    """For the ``explain`` of an error; empty without causes."""
    if not causes:
        return {}
    return {
        "families": list(dict.fromkeys(c.family for c in causes)),
        "limbs": list(dict.fromkeys(name for c in causes for name in c.limb.split("+") if name)),
        "causes": [c.as_dict() for c in causes],
        "text": "; ".join(c.text for c in causes[:3]),
        "advice": "; ".join(dict.fromkeys(c.advice for c in causes[:3])),
    }


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
    if family == "limb_height":
        return f"the limb {name} is {far} in the ground beside its foot", "another pattern, or a higher body"
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
