"""Where the seconds of a run go."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

STAGES = ("assemble", "footfall", "motion", "verify", "record")

Progress = Callable[[str, str], None]
"""(stage, what has just been done or found)"""


def silent(stage: str, message: str) -> None:
    """The progress that says nothing."""


@dataclass
class Stopwatch:
    """Seconds by stage, and who is told about progress."""

    progress: Progress = silent
    seconds: dict[str, float] = field(default_factory=lambda: dict.fromkeys(STAGES, 0.0))
    started: float = field(default_factory=time.perf_counter)

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Add the time of the block to a stage."""
        begin = time.perf_counter()
        try:
            yield
        finally:
            self.seconds[name] += time.perf_counter() - begin

    def timings(self) -> dict[str, float]:
        """`timings_s` of ``summary.json``: seconds by stage and in total."""
        return {**self.seconds, "total": time.perf_counter() - self.started}
