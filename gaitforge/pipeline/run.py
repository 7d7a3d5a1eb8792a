"""`run_task`: one robot, one task, one folder of results."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gaitforge.errors import GaitforgeError, InfeasibleError, InputError, UnsolvedError
from gaitforge.pipeline.files import write_plan_files, write_run_files, write_start_files, write_summary
from gaitforge.pipeline.options import Options
from gaitforge.pipeline.outcome import EXIT_CODES, RunOutcome
from gaitforge.pipeline.schedule import plan_task
from gaitforge.pipeline.segment import Segment
from gaitforge.pipeline.stopwatch import Stopwatch
from gaitforge.robot.model import RobotModel
from gaitforge.task.phase import Task
from gaitforge.verify.verdict import Verdict


@dataclass(frozen=True, eq=False)
class Run:
    """Everything about one run that does not change while it runs."""

    robot: RobotModel
    task: Task
    options: Options
    folder: Path
    config: Mapping[str, Any]
    """The composed config, for the manifest."""


def run_task(run: Run, watch: Stopwatch) -> RunOutcome:
    """Plan, verify and record a task; ``summary.json`` is written last and whatever happens.

    Only `InputError` (from here on: an output folder that cannot be written) and errors outside the
    project's own tree leave this function; the latter after the summary has been written.
    """
    run.folder.mkdir(parents=True, exist_ok=True)
    (run.folder / "summary.json").unlink(missing_ok=True)
    write_start_files(run.folder, run.robot, run.config, run.options.seed)
    segments: list[Segment] = []
    try:
        verdict = _plan_and_verify(run, watch, segments)
    except InputError:
        raise
    except GaitforgeError as error:
        return _failed(run, watch, segments, error.status, error.exit_code, error)
    except Exception as error:
        _failed(run, watch, segments, "error", 4, error)
        raise
    status = "verified" if verdict.passed else "unverified"
    summary = write_summary(run.folder, run.robot, run.task, status, segments, watch, verdict=verdict)
    failed = ", ".join(f"{c.name} of {c.segment}" for c in verdict.failed)
    return RunOutcome(status, EXIT_CODES[status], summary, run.folder, failed)


def _plan_and_verify(run: Run, watch: Stopwatch, segments: list[Segment]) -> Verdict:
    from gaitforge.motion.timeline_build import build_timeline
    from gaitforge.verify.verify import verify_timeline

    plan_task(run.robot, run.task, run.options, watch, segments)
    with watch.stage("motion"):
        timeline = build_timeline(run.robot, [(s.plan, s.cycles) for s in segments], run.task.scene)
    with watch.stage("record"):
        write_plan_files(run.folder, run.robot, timeline)
    limits = {} if run.options.limits is None else {"limits": run.options.limits}
    with watch.stage("verify"):
        verdict = verify_timeline(
            run.robot, timeline, run.task.scene, simulator=run.options.simulator, **limits,
        )  # fmt: skip
    watch.progress("verify", f"{verdict.simulator}: {timeline.duration:.1f} s simulated")
    with watch.stage("record"):
        write_run_files(run.folder, run.robot, run.task, run.options, verdict)
    watch.progress("record", "log, layout, plots and report")
    return verdict


def _failed(
    run: Run, watch: Stopwatch, segments: list[Segment], status: str, code: int, error: Exception
) -> RunOutcome:
    explain = error.explain if isinstance(error, InfeasibleError | UnsolvedError) else None
    known = isinstance(error, GaitforgeError)
    what = error.as_dict() if known else {
        "type": type(error).__name__, "file": None, "key": None, "found": str(error), "expected": None,
    }  # fmt: skip
    summary = write_summary(
        run.folder, run.robot, run.task, status, segments, watch, explain=explain, error=what
    )
    return RunOutcome(status, code, summary, run.folder, str(error))
