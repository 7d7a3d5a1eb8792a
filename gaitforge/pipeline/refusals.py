"""Plans that failed in simulation, which are not made again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.pipeline.segment import Attempt, Segment
from gaitforge.pipeline.tries import Try
from gaitforge.verify.verdict import Check, Verdict

Identity = tuple[bytes, float]


@dataclass(frozen=True)
class Refusal:
    """A gait or transition that a simulator refused; others are planned in its place."""

    segment: str
    identity: Identity
    """Contact pattern, of a gait by whichever column it begins; and, of a transition, seconds"""
    why: str


def refused(verdict: Verdict, segments: Sequence[Segment]) -> tuple[Refusal, ...]:
    """What is to blame for the checks that failed: a gait or transition for its own, and for those of the stand at
    its side; after a fall nothing more is.  Empty when all is well, or when only stands are to blame.

    A gait that comes several times is refused everywhere.
    """
    names = [s.plan.name for s in segments]
    blame: dict[int, list[Check]] = {}
    for check in sorted(verdict.failed, key=lambda c: names.index(c.segment)):
        if (index := _to_blame(segments, names.index(check.segment))) is not None:
            blame.setdefault(index, []).append(check)
        if check.name == "fallen":
            break
    told = {_identity_of(segments[i]): _words(names[i], checks) for i, checks in blame.items()}
    return tuple(Refusal(s.plan.name, who, told[who]) for s in segments if (who := _identity_of(s)) in told)


def allowed(tries: Sequence[Try], refusals: Sequence[Refusal]) -> tuple[list[Try], list[Attempt]]:
    """(the tries that no simulator has refused yet; the entries of the others)."""
    why = {(r.segment, r.identity): r.why for r in refusals}
    known = [(one, why.get((one.named["name"], _identity_of_try(one)))) for one in tries]
    return [one for one, w in known if w is None], [Attempt(one.what, w, 0.0) for one, w in known if w is not None]


def _to_blame(segments: Sequence[Segment], index: int) -> int | None:
    """The segment itself, or the gait that a stand begins or ends."""
    if segments[index].plan.kind != "stand":
        return index
    for neighbour in (index + 1, index - 1):
        if 0 <= neighbour < len(segments) and segments[neighbour].plan.kind == "gait":
            return neighbour
    return None


def _words(name: str, checks: Sequence[Check]) -> str:
    where = {c: "" if c.segment == name else f" of {c.segment}" for c in checks}
    said = (f"{c.name}{of} {c.value:.4g} {c.unit} in {c.simulator}" for c, of in where.items())
    return "refused: " + ", ".join(said)


def _identity_of(segment: Segment) -> Identity:
    return _identity(segment.plan.pattern, segment.plan.duration)


def _identity_of_try(one: Try) -> Identity:
    pattern: FootfallPattern = one.positional[0] if one.kind == "gait" else one.named["pattern"]
    return _identity(pattern, one.named.get("column_s", 0.0) * pattern.columns)


def _identity(pattern: FootfallPattern, seconds: float) -> Identity:
    if not pattern.cyclic:
        return pattern.contact.tobytes(), round(seconds, 6)
    return min(np.roll(pattern.contact, k, axis=1).tobytes() for k in range(pattern.columns)), 0.0
