"""What a run is about, and what it came to."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from gaitforge.pipeline.options import Options
from gaitforge.robot.model import RobotModel
from gaitforge.task.phase import Task

EXIT_CODES: Mapping[str, int] = {"verified": 0, "unverified": 1, "error": 4, "infeasible": 3, "unsolved": 5}
"""Status → exit code; an `InputError` has status "error" and brings its own code, 2."""


@dataclass(frozen=True, eq=False)
class Run:
    """What one run is about."""

    robot: RobotModel
    task: Task
    options: Options
    folder: Path
    config: Mapping[str, Any]
    """The composed config, for the manifest."""


@dataclass(frozen=True)
class RunOutcome:
    """Status, exit code, and the summary as it stands in ``summary.json``."""

    status: str
    code: int
    summary: Mapping[str, Any] = field(repr=False)
    folder: Path
    message: str = ""
    """Why there is no verified result; "" when there is one."""
