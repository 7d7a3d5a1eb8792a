"""`run_experiment`: jobs → rows → ``results.json``, page and exit code."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from gaitforge.errors import GaitforgeError, InputError, Problem
from gaitforge.experiment.acceptance import accepted
from gaitforge.experiment.experiment import Experiment, Job, Row, Tools
from gaitforge.experiment.processes import Processes
from gaitforge.experiment.results import Outcome, write_results
from gaitforge.experiment.store import RowStore
from gaitforge.pipeline.manifest import code_hash, config_hash, versions
from gaitforge.pipeline.options import Options
from gaitforge.pipeline.stopwatch import Progress, silent

RUNTIME = ("title", "only", "workers", "logs", "resume", "accept")
"""What rows do not depend on."""


@dataclass(frozen=True, eq=False)
class ExperimentRun:
    """What one run of an experiment is about."""

    name: str
    experiment: Experiment
    options: Options
    folder: Path
    config: Mapping[str, Any]
    """The composed config"""
    command: str = ""
    """As it was typed, for the page"""


def run_experiment(run: ExperimentRun, progress: Progress = silent) -> Outcome:
    """Measure every selected job that the folder has no rows of; a bad row never ends the others.

    Raises `InputError` for data that make no sense, before anything is measured.
    """
    begin, experiment = time.perf_counter(), run.experiment
    jobs = experiment.selected()
    if not jobs:
        raise _nothing_selected(experiment)
    run.folder.mkdir(parents=True, exist_ok=True)
    store = RowStore(run.folder / "rows", fingerprints(run.config, experiment, jobs))
    rows: dict[str, list[Row]] = {job.key: found for job in jobs if (found := store.finished(job.key)) is not None}
    pending = [job for job in jobs if job.key not in rows]
    if rows:
        progress("verify", f"{len(rows)} of {len(jobs)} jobs were measured before")
    if stale := sum(store.has(job.key) for job in pending):
        progress("verify", f"{stale} are measured again: by other code, libraries or config, or without a result")
    with Processes(min(experiment.workers, max(len(pending), 1))) as work:
        for job, measured in _measured(run, pending, work, progress):
            rows[job.key] = measured
            store.write(job.key, measured)
            for row in measured:
                progress("verify", f"{len(rows)}/{len(jobs)} {job.key}: {experiment.told(row)}")
    ordered = [_judged(row, experiment) for job in jobs for row in rows[job.key]]
    return write_results(run.name, experiment, ordered, run.folder, run.command, time.perf_counter() - begin)


def fingerprints(config: Mapping[str, Any], experiment: Experiment, jobs: Sequence[Job]) -> dict[str, str]:
    """Key of a job → hash of what its rows depend on: config, its robot, gaitforge's code, the libraries' versions."""
    kept = {k: v for k, v in config.items() if k not in ("record", "robot", "task", "verify")}
    left_out = (*RUNTIME, *experiment.choosing)
    kept["experiment"] = {k: v for k, v in dict(kept.get("experiment") or {}).items() if k not in left_out}
    every = {"config": config_hash(kept), "code": code_hash(), "with": versions()}
    made_of = dict(experiment.made_of())
    return {
        job.key: config_hash({**every, "made_of": made_of.get(str(job.case.get("robot")), made_of)}) for job in jobs
    }


def _measured(
    run: ExperimentRun, jobs: Sequence[Job], work: Processes, progress: Progress
) -> Iterator[tuple[Job, list[Row]]]:
    experiment = run.experiment
    logs = run.folder / "logs" if experiment.logs else None
    search = replace(run.options.search, workers=1)  # rows are the parallelism
    tools = Tools(replace(run.options, search=search), experiment.simulators, logs)
    started: list[Job] = []
    ready = _noted(experiment.prepare(jobs, work, tools, progress) if jobs else (), started)
    for index, result in work.run((_measure, (job, tools)) for job in ready):
        job = started[index]
        yield job, [_failed(job, result)] if isinstance(result, Exception) else result


def _noted(jobs: Iterable[Job], noted: list[Job]) -> Iterator[Job]:
    for job in jobs:
        noted.append(job)
        yield job


def _measure(job: Job, tools: Tools) -> list[Row]:
    begin = time.perf_counter()
    rows = job.measure(tools)
    return [{"key": job.key, "measured": True, **row, "seconds": time.perf_counter() - begin} for row in rows]


def _failed(job: Job, error: Exception) -> Row:
    status = error.status if isinstance(error, GaitforgeError) else "error"
    text = str(error) if isinstance(error, GaitforgeError) else f"{type(error).__name__}: {error}"
    return {"key": job.key, **job.case, "status": status, "measured": False, "error": text}


def _judged(row: Row, experiment: Experiment) -> dict[str, Any]:
    holds, broken = accepted(row, experiment.rules)
    return {**row, "accepted": holds, "broken": broken}


def _nothing_selected(experiment: Experiment) -> InputError:
    keys = ", ".join(job.key for job in experiment.jobs()[:8])
    return InputError(Problem("experiment", "only", repr(list(experiment.only)), f"patterns of keys such as {keys}"))
