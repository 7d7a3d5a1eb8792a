"""Plans that failed in simulation, which are not made again."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np

from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion.plan import MotionPlan
from gaitforge.pipeline.search.segment import Attempt, Segment
from gaitforge.pipeline.search.tries import Try
from gaitforge.verify.verdict import Check, Verdict

Identity = tuple[bytes, float]


@dataclass(frozen=True)
class Refusal:
    """A segment that a simulator refused; others are planned in its place."""

    segment: str
    identity: Identity
    """Contact pattern, of a gait by whichever column it begins; of the others seconds, too"""
    why: str


def refused(verdict: Verdict, segments: Sequence[Segment], earlier: Sequence[Refusal] = ()) -> tuple[Refusal, ...]:
    """The segments whose checks failed; after a fall no later ones.  A gait that comes twice is refused everywhere.

    With a stand that was refused `earlier` as well the gait is refused that it begins or ends, or else the steps that
    led to it.
    """
    names, before = [s.plan.name for s in segments], {r.segment for r in earlier}
    blame: dict[int, list[Check]] = {}
    for check in sorted(verdict.failed, key=lambda c: names.index(c.segment)):
        index = names.index(check.segment)
        blame.setdefault(index, []).append(check)
        if check.segment in before and (other := _beside(segments, index)) is not None:
            blame.setdefault(other, []).append(check)
        if check.name == "fallen":
            break
    told = {_same(segments[i].plan): _words(checks) for i, checks in blame.items()}
    return tuple(
        Refusal(s.plan.name, _identity_of(s.plan), told[_same(s.plan)]) for s in segments if _same(s.plan) in told
    )


def allowed(tries: Sequence[Try], refusals: Sequence[Refusal]) -> tuple[list[Try], list[Attempt]]:
    """(the tries that no simulator has refused yet; the entries of the others)."""
    why = {(r.segment, r.identity): r.why for r in refusals}
    known = [(one, why.get((one.named["name"], _identity_of_try(one)))) for one in tries]
    return [one for one, w in known if w is None], [Attempt(one.what, w, 0.0) for one, w in known if w is not None]


def why_refused(plan: MotionPlan, refusals: Sequence[Refusal]) -> str | None:
    """What a simulator has refused this plan for, by its pattern and time; None for one that it has not."""
    who = plan.name, _identity_of(plan)
    return next((r.why for r in refusals if (r.segment, r.identity) == who), None)


def first_allowed(plans: Iterable[MotionPlan], refusals: Sequence[Refusal]) -> MotionPlan:
    """Of plans made one after the other the first that no simulator has refused; the first of all if each was."""
    ways = iter(plans)
    first = next(ways)
    return next((plan for plan in chain([first], ways) if why_refused(plan, refusals) is None), first)


def _beside(segments: Sequence[Segment], index: int) -> int | None:
    """Of a stand: the gait that follows, or that comes before; or the steps from another stand that led to it."""
    kinds = [s.plan.kind for s in segments]
    if kinds[index] != "stand":
        return None
    for other in (index + 1, index - 1):
        if 0 <= other < len(segments) and kinds[other] == "gait":
            return other
    before = max((i for i in range(index) if kinds[i] != "stand"), default=0)
    return before if before and kinds[before - 1] == "stand" else None


def _same(plan: MotionPlan) -> tuple[str, Identity]:
    """What two segments share that are refused together: gaits whatever their names."""
    return "" if plan.kind == "gait" else plan.name, _identity_of(plan)


def _words(checks: Sequence[Check]) -> str:
    return "refused: " + ", ".join(f"{c.name} {c.value:.4g} {c.unit} in {c.simulator}" for c in checks)


def _identity_of(plan: MotionPlan) -> Identity:
    return _identity(plan.pattern, plan.duration)


def _identity_of_try(one: Try) -> Identity:
    pattern: FootfallPattern = one.positional[0] if one.kind == "gait" else one.named["pattern"]
    return _identity(pattern, one.named.get("column_s", 0.0) * pattern.columns)


def _identity(pattern: FootfallPattern, seconds: float) -> Identity:
    if not pattern.cyclic:
        return pattern.contact.tobytes(), round(seconds, 6)
    return min(np.roll(pattern.contact, k, axis=1).tobytes() for k in range(pattern.columns)), 0.0
