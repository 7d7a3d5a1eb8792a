"""What a check is: one question, asked of one segment of a simulated run."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.timeline import Entry, Timeline
from gaitforge.robot.model import RobotModel
from gaitforge.verify.checks.limits import CheckLimits, SegmentLimits
from gaitforge.verify.trace import Trace

Array = NDArray[np.float64]
Rows = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Segment:
    """One entry of the timeline with its part of the trace."""

    robot: RobotModel
    timeline: Timeline
    trace: Trace
    entry: Entry
    limits: CheckLimits

    @property
    def limit(self) -> SegmentLimits:
        """Limits of this kind of segment."""
        return self.limits.of(self.entry.plan.kind)

    @cached_property
    def rows(self) -> Rows:
        """Rows of the trace from the start to the end of the entry."""
        return self._between(self.entry.start, self.entry.end)

    @cached_property
    def judged(self) -> Rows:
        """Rows of whole cycles, the first cycle of a gait left out when it has more than one."""
        return self._between(self.entry.start + self._first * self.entry.plan.duration, self.entry.end)

    @cached_property
    def cycles(self) -> NDArray[np.intp]:
        """(k, 2) first and last row of each judged cycle."""
        ends = self.entry.start + np.arange(self._first, self.entry.cycles + 1) * self.entry.plan.duration
        rows = np.clip(np.searchsorted(self.trace.times, ends - 1e-9), 0, len(self.trace.times) - 1)
        return np.stack([rows[:-1], rows[1:]], axis=1)

    @property
    def dt(self) -> float:
        """[s] between rows"""
        return float(self.trace.times[1] - self.trace.times[0])

    @property
    def _first(self) -> int:
        return 1 if self.entry.plan.kind == "gait" and self.entry.cycles > 1 else 0

    def _between(self, start: float, end: float) -> Rows:
        first, last = np.searchsorted(self.trace.times, [start - 1e-9, end + 1e-9])
        return np.arange(first, max(last, first + 1), dtype=np.intp)


@dataclass(frozen=True)
class Finding:
    """The answer to one question."""

    value: float
    limit: float | None
    """None: reported, not judged"""
    unit: str
    passed: bool = True

    @staticmethod
    def at_most(value: float, limit: float | None, unit: str) -> Finding:
        """Good when the value is at most the limit, or when there is none."""
        return Finding(float(value), limit, unit, limit is None or bool(value <= limit))

    @staticmethod
    def at_least(value: float, limit: float | None, unit: str) -> Finding:
        """Good when the value is at least the limit, or when there is none."""
        return Finding(float(value), limit, unit, limit is None or bool(value >= limit))


class SegmentCheck(ABC):
    """One question. A new check is one frozen class and one line in `gaitforge.verify.checks.ALL`."""

    name: ClassVar[str]
    """As it stands in `Check.name`."""
    title: ClassVar[str]
    """What is asked, in a few words."""

    @abstractmethod
    def find(self, segment: Segment) -> Finding | None:
        """The answer, or None where the question makes no sense."""
