"""What a job of the command line came to."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

Say = Callable[[str], None]


@dataclass(frozen=True)
class JobOutcome:
    """What the command line needs to know of a finished job; goes between processes."""

    code: int
    status: str
    robot: str
    task: str
    folder: str
    seconds: float = 0.0
    message: str = ""
