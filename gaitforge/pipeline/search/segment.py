"""A planned segment, and what was tried on the way to it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from gaitforge.motion.plan import MotionPlan


@dataclass(frozen=True)
class Attempt:
    """One try that was left, and why."""

    what: str
    """e.g. "program, 12 columns, 2.0 s" """
    why: str
    seconds: float

    def as_dict(self) -> dict[str, Any]:
        """For ``summary.json``."""
        return {"what": self.what, "why": self.why, "seconds": round(self.seconds, 4)}


@dataclass(frozen=True, eq=False)
class Segment:
    """A motion plan, how often it is executed, and the attempts before it that were left."""

    plan: MotionPlan
    cycles: int = 1
    left: tuple[Attempt, ...] = ()


def exhausted(name: str, attempts: list[Attempt], why: Mapping[str, Any] | None = None) -> Mapping[str, Any]:
    """The `explain` entry of a search that ended with nothing; `why`: what is known of its first try."""
    return {**(why or {}), "segment": name, "tried": [a.as_dict() for a in attempts]}
