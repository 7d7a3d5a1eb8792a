"""`run_task`: one robot, one task, one folder of results."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

from gaitforge.errors import GaitforgeError, InputError
from gaitforge.pipeline.files import write_log_files, write_plan_files, write_report, write_start_files
from gaitforge.pipeline.run import EXIT_CODES, Run, RunOutcome
from gaitforge.pipeline.schedule import plan_task
from gaitforge.pipeline.search.segment import Segment
from gaitforge.pipeline.stopwatch import Stopwatch
from gaitforge.report.summary import build_summary, segment_entry, write_summary
from gaitforge.verify.agreement import opinions
from gaitforge.verify.verdict import Verdict


def run_task(run: Run, watch: Stopwatch) -> RunOutcome:
    """Plan, verify and record a task; ``summary.json`` is written last, and whatever happens.

    `InputError` (a limb that does not exist, a folder that cannot be written) and errors that are not
    the project's own leave this function, the latter after the summary has been written.
    """
    run.folder.mkdir(parents=True, exist_ok=True)
    (run.folder / "summary.json").unlink(missing_ok=True)
    write_start_files(run)
    segments: list[Segment] = []
    try:
        verdict = _plan_and_verify(run, watch, segments)
    except InputError:
        raise
    except GaitforgeError as error:
        return _finish(run, watch, segments, error.status, error.exit_code, error=error)
    except Exception as error:
        _finish(run, watch, segments, "error", EXIT_CODES["error"], error=error)
        raise
    status = "verified" if verdict.passed else "unverified"
    return _finish(run, watch, segments, status, EXIT_CODES[status], verdict=verdict)


def _plan_and_verify(run: Run, watch: Stopwatch, segments: list[Segment]) -> Verdict:
    from gaitforge.pipeline.proving import proven

    plan_task(run.robot, run.task, run.options, watch, segments)
    found = proven(run.robot, run.task, run.options, watch, segments, partial(_execute, run, watch))
    segments[:] = found.segments
    with watch.stage("record"):
        if found.verdict is not found.verdicts[-1]:
            write_plan_files(run.folder, run.robot, found.verdict.timeline)
        write_log_files(run, found.verdict)
    watch.progress("record", "log, layout and plots")
    return found.verdict


def _execute(run: Run, watch: Stopwatch, segments: Sequence[Segment]) -> Verdict:
    from gaitforge.motion.timeline_build import build_timeline
    from gaitforge.verify.verify import verify_timeline

    with watch.stage("motion"):
        timeline = build_timeline(run.robot, [(s.plan, s.cycles) for s in segments], run.task.scene)
    with watch.stage("record"):
        write_plan_files(run.folder, run.robot, timeline)
    watch.progress("verify", f"{timeline.duration:.1f} s to simulate in {run.options.simulator.name}")
    with watch.stage("verify"):
        verdict = verify_timeline(
            run.robot,
            timeline,
            run.task.scene,
            simulator=run.options.simulator,
            limits=run.options.limits,
            progress=_in_quarters(watch),
        )
    watch.progress("verify", f"{len(verdict.checks)} checks, {len(verdict.failed)} failed")
    return verdict


def _in_quarters(watch: Stopwatch) -> Callable[[float], None]:
    """Tells the progress of a simulation at 25, 50 and 75 %."""
    told = 0

    def tell(fraction: float) -> None:
        nonlocal told
        quarter = int(4.0 * fraction)
        if told < quarter < 4:
            watch.progress("verify", f"{25 * quarter} %")
            told = quarter

    return tell


def _finish(
    run: Run, watch: Stopwatch, segments: list[Segment], status: str, code: int, *,
    verdict: Verdict | None = None, error: Exception | None = None,
) -> RunOutcome:  # fmt: skip
    def summary() -> dict[str, Any]:
        return build_summary(
            robot=run.robot.name,
            task=run.task.name,
            status=status,
            segments=_entries(segments, verdict),
            checks=verdict.checks if verdict else (),
            timings=watch.timings(),
            opinions=opinions(verdict) if verdict else None,
            ignored_contacts=verdict.ignored_contacts if verdict else None,
            welded=verdict.welded if verdict else (),
            explain=getattr(error, "explain", None),
            error=_error_entry(error) if status == "error" else None,
        )

    with watch.stage("record"):
        write_report(run, summary(), verdict)
    final = summary()
    write_summary(run.folder / "summary.json", final)
    return RunOutcome(status, code, final, run.folder, str(error or ""))


def _entries(segments: list[Segment], verdict: Verdict | None) -> list[dict[str, Any]]:
    speeds: list[float | None] = [*verdict.speeds] if verdict else [None] * len(segments)
    return [
        {**segment_entry(s.plan, speed), "left": [a.as_dict() for a in s.left]}
        for s, speed in zip(segments, speeds, strict=True)
    ]


def _error_entry(error: Exception | None) -> Mapping[str, Any]:
    if isinstance(error, GaitforgeError):
        return error.as_dict()
    return {"type": type(error).__name__, "file": None, "key": None, "found": str(error), "expected": None}
