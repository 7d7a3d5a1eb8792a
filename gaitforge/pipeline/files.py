"""Which file of a run is written when; each one whole or not at all, ``summary.json`` last."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gaitforge.motion.timeline import Timeline
from gaitforge.pipeline.manifest import manifest
from gaitforge.pipeline.segment import Segment
from gaitforge.pipeline.stopwatch import Stopwatch
from gaitforge.record.files import write_json, write_text
from gaitforge.robot.model import RobotModel
from gaitforge.task.phase import Task

if TYPE_CHECKING:
    from gaitforge.pipeline.options import Options
    from gaitforge.verify.verdict import Verdict


def write_start_files(folder: Path, robot: RobotModel, config: Mapping[str, Any], seed: int) -> None:
    """``robot.urdf`` and ``manifest.json``, known before anything is planned."""
    write_text(folder / "robot.urdf", robot.urdf)
    write_json(folder / "manifest.json", manifest(config, robot.urdf, seed))


def write_plan_files(folder: Path, robot: RobotModel, timeline: Timeline) -> None:
    """``plan.npz``, ``footfall.csv`` and ``footfall.png``."""
    from gaitforge.record import write_plan_npz
    from gaitforge.report.footfall_plot import write_footfall_csv, write_footfall_png

    write_plan_npz(folder / "plan.npz", robot, timeline)
    write_footfall_csv(folder / "footfall.csv", timeline)
    write_footfall_png(folder / "footfall.png", timeline)


def write_run_files(folder: Path, run: Run, verdict: Verdict) -> None:
    """``run.mcap``, ``run.layout.json`` and ``report.html``, once the run has been simulated."""
