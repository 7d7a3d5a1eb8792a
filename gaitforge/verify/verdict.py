"""The judgement: checks with value, limit and unit."""

from __future__ import annotations

from dataclasses import dataclass

from gaitforge.motion.timeline import Timeline
from gaitforge.verify.trace import Trace


@dataclass(frozen=True)
class Check:
    """One question put to the simulated run."""

    name: str
    """speed · heading · tilt · body_height · slip · unplanned_contact · static_margin · camera_pointing · …"""
    segment: str
    simulator: str
    value: float
    limit: float | None
    """None: reported, not judged"""
    unit: str
    passed: bool


@dataclass(frozen=True, eq=False)
class Verdict:
    """All checks of a timeline in one simulator, or in several that were asked one after the other."""

    simulator: str
    """Where the trace and the speeds come from."""
    checks: tuple[Check, ...]
    """Those of the other simulators among them."""
    trace: Trace
    timeline: Timeline
    speeds: tuple[float, ...] = ()
    """Measured mean speed of each timeline entry [m/s]."""
    others: tuple[Verdict, ...] = ()
    """What the other simulators found on their own."""

    @property
    def simulators(self) -> tuple[str, ...]:
        """All that were asked."""
        return self.simulator, *(other.simulator for other in self.others)

    @property
    def ignored_contacts(self) -> dict[str, list[list[str]]]:
        """simulator → pairs of links whose shapes overlap in the nominal posture; only simulators that found some."""
        found = {v.simulator: [list(pair) for pair in v.trace.overlapping] for v in (self, *self.others)}
        return {simulator: pairs for simulator, pairs in found.items() if pairs}

    @property
    def welded(self) -> tuple[str, ...]:
        """Objects that a weld held, and not friction."""
        held = (h for entry in self.timeline.entries for h in entry.plan.holdings if h.welded)
        return tuple(dict.fromkeys(h.object for h in held))

    @property
    def passed(self) -> bool:
        """Verified, by every simulator that was asked?"""
        return all(c.passed for c in self.checks)

    @property
    def failed(self) -> tuple[Check, ...]:
        """The checks that did not hold."""
        return tuple(c for c in self.checks if not c.passed)
