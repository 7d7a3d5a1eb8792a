"""``results.json``, ``results.md`` and ``results.png``: what an experiment leaves (docs/experiments.md)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from gaitforge.experiment.experiment import Experiment
from gaitforge.pipeline.manifest import git_commit, versions
from gaitforge.pipeline.run import EXIT_CODES
from gaitforge.record.files import write_bytes, write_json, write_text
from gaitforge.report.results_page import results_page
from gaitforge.report.summary import plain

SCHEMA = 1
"""Of ``results.json``: raised when a key goes, changes its meaning or its type."""


@dataclass(frozen=True)
class Outcome:
    """Status, exit code, and ``results.json`` as it was written."""

    status: str
    code: int
    results: Mapping[str, Any] = field(repr=False)
    folder: Path


def write_results(
    name: str, experiment: Experiment, rows: Sequence[Mapping[str, Any]], folder: Path, command: str, seconds: float
) -> Outcome:
    """Write the picture, the page and, last, ``results.json``; InputError when the folder cannot be written."""
    from gaitforge import __version__

    status = overall(rows)
    judged = [row for row in rows if row["accepted"] is not None]
    results = plain({
        "schema": SCHEMA,
        "experiment": name,
        "title": experiment.title,
        "status": status,
        "counts": {
            "rows": len(rows),
            "measured": sum(bool(row["measured"]) for row in rows),
            "judged": len(judged),
            "accepted": sum(bool(row["accepted"]) for row in judged),
        },
        "rows": rows,
        "columns": [{"key": c.key, "title": c.title, "scale": c.scale} for c in experiment.columns],
        "command": command,
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "seconds": seconds,
        "git_commit": git_commit(Path(__file__).parents[1]),
        "versions": {"gaitforge": __version__, **versions()},
    })  # fmt: skip
    drawn = experiment.picture(rows)
    if drawn is not None:
        write_bytes(folder / "results.png", drawn)
    page = results_page(results, experiment.columns, "results.png" if drawn is not None else None)
    write_text(folder / "results.md", page)
    write_json(folder / "results.json", results)
    return Outcome(status, EXIT_CODES[status], results, folder)


def overall(rows: Sequence[Mapping[str, Any]]) -> str:
    """*verified* when every row was measured and what has to hold of it holds; else the worst that happened.

    A row that was measured and that no rule speaks of, a baseline that falls say, is a result.
    """
    unmeasured = {row["status"] for row in rows if not row["measured"]}
    for status in ("error", "infeasible", "unsolved"):
        if status in unmeasured:
            return status
    return "unverified" if any(row["accepted"] is False for row in rows) else "verified"
