"""What a person reads on the terminal."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gaitforge.cli.interrupt import stop_if_requested

if TYPE_CHECKING:
    from gaitforge.cli.outcome import JobOutcome
    from gaitforge.experiment.results import Outcome
    from gaitforge.pipeline.run import RunOutcome
    from gaitforge.report.results_page import Column
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
        """A line of progress; the moment to stop when the user has asked for it."""
        stop_if_requested()
        self._say(f"  {time.perf_counter() - self._started:6.1f} s  {stage:<9} {message}")


def summary_text(outcome: RunOutcome) -> str:
    """The closing summary: segments with planned and measured speeds, verdict, files, how to open the log."""
    from gaitforge.report.text import checks_text, ignored_text, opinions_text, problem_text, segments_text, welded_text

    summary = outcome.summary
    parts = [segments_text(summary)] if summary["segments"] else []
    parts.append(_verdict(outcome))
    if summary["welded"]:
        parts.append(welded_text(summary))
    if summary["opinions"]:
        parts.append(opinions_text(summary))
    if summary["ignored_contacts"]:
        parts.append(ignored_text(summary))
    if any(not check["passed"] for check in summary["checks"]):
        parts.append(checks_text(summary, failed_only=True))
    problems = [s for s in summary["segments"] if s.get("problem")]
    parts += [f"motion problem of {s['name']}\n{problem_text(s['problem'])}" for s in problems]
    parts.append(_files(outcome.folder))
    return "\n" + "\n\n".join(parts)


def _verdict(outcome: RunOutcome) -> str:
    summary = outcome.summary
    judged = [c for c in summary["checks"] if c["limit"] is not None]
    held = f": {sum(c['passed'] for c in judged)} of {len(judged)} checks hold" if judged else ""
    why = f": {outcome.message}" if outcome.message else ""
    advice = (summary.get("explain") or {}).get("advice")
    said = f"\n{advice}" if advice and advice not in outcome.message else ""
    return f"{outcome.status}{held}{why} ({summary['timings_s']['total']:.1f} s){said}"


def _files(folder: Path) -> str:
    lines = [f"files   {_short(folder)}"]
    if (folder / "run.mcap").exists():
        lines.append("log     open run.mcap in Foxglove or Lichtblick and import run.layout.json as the layout")
    if (folder / "report.html").exists():
        lines.append("report  report.html")
    return "\n".join(lines)


def experiment_text(outcome: Outcome, columns: Sequence[Column]) -> str:
    """The closing table of an experiment, its verdict, and where its files are."""
    from gaitforge.report.text import table

    results = outcome.results
    rows, counts = results["rows"], results["counts"]
    shown = [c for c in columns if any(row.get(c.key) is not None for row in rows)]
    cells = [[*(c.text(row) for c in shown), _mark(row)] for row in rows]
    verdict = (
        f"{outcome.status}: {counts['measured']} of {counts['rows']} rows measured, "
        f"{counts['accepted']} of {counts['judged']} accepted ({results['seconds']:.1f} s)"
    )
    files = f"files   {_short(outcome.folder)}: results.json, results.md"
    return "\n" + "\n\n".join([table([*(c.title for c in shown), ""], cells), verdict, files])


def _mark(row: Mapping[str, Any]) -> str:
    return {True: "✓", False: "✗", None: "·"}[row["accepted"]] if row["measured"] else str(row["status"])


def _short(path: Path) -> str:
    """Relative to the working directory when it lies below it."""
    return str(path.relative_to(Path.cwd())) if path.is_relative_to(Path.cwd()) else str(path)


def sweep_table(jobs: Sequence[JobOutcome], refused: Sequence[str]) -> str:
    """One row for every job of a multirun."""
    from gaitforge.report.text import table

    header = ("robot", "task", "status", "exit", "time [s]", "folder")
    rows = [
        (j.robot, j.task, j.status, str(j.code), f"{j.seconds:.1f}", _short(Path(j.folder)) if j.code != 2 else "–")
        for j in jobs
    ]
    left = [f"not run, bad input: {overrides}" for overrides in refused]
    return "\n" + "\n".join([table(header, rows), *left] if rows else left)
