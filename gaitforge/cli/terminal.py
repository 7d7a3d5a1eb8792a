"""What a person reads on the terminal."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gaitforge.cli.job import JobOutcome
    from gaitforge.pipeline.outcome import RunOutcome
    from gaitforge.robot.model import RobotModel


class Narrator:
    """One line for every thing that a stage has done, with the time since the start."""

    def __init__(self, say: Callable[[str], None]) -> None:
        self._say = say
        self._started = time.perf_counter()

    def title(self, robot: str, task: str) -> None:
        """The first line."""
        self._say(f"gaitforge · {robot} · {task}")

    def robot(self, robot: RobotModel) -> None:
        """What was recognised in the robot."""
        tools = ", ".join(f"{t.name} on {t.limb}" for t in robot.tools)
        carried = f"; {tools}" if tools else ""
        limbs = f"{len(robot.limbs)} limbs ({' '.join(robot.limb_names)})"
        self.progress("assemble", f"{robot.modules} modules, {robot.mass:.2f} kg, {limbs}{carried}")

    def progress(self, stage: str, message: str) -> None:
        """A line of progress."""
        self._say(f"  {time.perf_counter() - self._started:6.1f} s  {stage:<9} {message}")


def summary_text(outcome: RunOutcome) -> str:
    """The closing summary: segments with planned and measured speeds, verdict, files, how to open the log."""
    summary = outcome.summary
    lines = ["", *_segment_table(summary["segments"])] if summary["segments"] else [""]
    lines += ["", _verdict(outcome, summary)]
    lines += [f"  {check}" for check in _failed_checks(summary["checks"])]
    explain = summary.get("explain") or {}
    lines += [f"  advice: {explain['advice']}"] if explain.get("advice") else []
    lines += ["", f"files    {outcome.folder}"]
    if (outcome.folder / "run.mcap").exists():
        lines += [
            f"log      open {_short(outcome.folder / 'run.mcap')} in Foxglove or Lichtblick,",
            "         then import run.layout.json beside it as the layout",
            f"report   {_short(outcome.folder / 'report.html')}",
        ]
    return "\n".join(lines)


def _segment_table(segments: Sequence[Mapping[str, Any]]) -> list[str]:
    rows = [("segment", "kind", "limbs", "pattern", "columns", "time", "planned", "measured")]
    for s in segments:
        rows.append((
            s["name"], s["kind"], str(len(s["limbs_locomotive"])), s["source"], str(s["columns"]),
            f"{s['duration_s']:.2f} s", _speed(s["speed_planned_m_s"]), _speed(s["speed_measured_m_s"]),
        ))  # fmt: skip
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    return ["  " + "  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)).rstrip() for row in rows]


def _speed(value: float | None) -> str:
    return "–" if value is None else f"{100 * value:.2f} cm/s"


def _verdict(outcome: RunOutcome, summary: Mapping[str, Any]) -> str:
    judged = [c for c in summary["checks"] if c["limit"] is not None]
    passed = sum(c["passed"] for c in judged)
    checks = f", {passed} of {len(judged)} checks hold" if judged else ""
    why = f": {outcome.message}" if outcome.message and not judged else ""
    return f"{outcome.status}{checks}{why} ({summary['timings_s']['total']:.1f} s)"


def _failed_checks(checks: Sequence[Mapping[str, Any]]) -> list[str]:
    return [
        f"✗ {c['name']} in {c['segment']} ({c['simulator']}): {c['value']:.4g} {c['unit']}, limit {c['limit']:.4g}"
        for c in checks
        if not c["passed"] and c["value"] is not None and c["limit"] is not None
    ]


def _short(path: Path) -> str:
    """Relative to the working directory when it lies below it."""
    return str(path.relative_to(Path.cwd())) if path.is_relative_to(Path.cwd()) else str(path)


def sweep_table(jobs: Sequence[JobOutcome], refused: Sequence[str]) -> str:
    """One row for every job of a multirun."""
    rows = [("robot", "task", "status", "exit", "time", "folder")]
    rows += [
        (j.robot, j.task, j.status, str(j.code), f"{j.seconds:.1f} s", _short(Path(j.folder)) if j.code != 2 else "–")
        for j in jobs
    ]
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    lines = ["  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)).rstrip() for row in rows]
    return "\n".join(["", *lines, *(f"not run (bad input): {overrides}" for overrides in refused)])
