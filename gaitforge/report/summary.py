"""``summary.json``: the contract between a run and whatever reads its result (docs/summary_json.md)."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.timeline import Timeline
from gaitforge.record.files import write_json
from gaitforge.verify.verdict import Check

SCHEMA = 1
"""Version of the contract: raised when a key goes, changes its meaning or its type; not when one is added."""

STATUSES = ("verified", "unverified", "infeasible", "unsolved", "error")
STAGES = ("assemble", "footfall", "motion", "verify", "record", "total")
ERROR_KEYS = ("type", "file", "key", "found", "expected")


def build_summary(
    *,
    robot: str,
    task: str,
    status: str,
    segments: Sequence[Mapping[str, Any]] = (),
    checks: Iterable[Check] = (),
    timings: Mapping[str, float] | None = None,
    opinions: Mapping[str, Any] | None = None,
    ignored_contacts: Mapping[str, Any] | None = None,
    welded: Sequence[str] = (),
    explain: Mapping[str, Any] | None = None,
    error: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """The summary of a run as JSON types; numbers that are not finite become null.

    Parameters
    ----------
    segments
        What `segment_entry` or `segment_entries` gave.
    timings
        [s] by stage; stages that were not reached are 0.
    opinions
        What `gaitforge.verify.agreement.opinions` gave.
    ignored_contacts
        `Verdict.ignored_contacts`.
    welded
        `Verdict.welded`.
    error
        `GaitforgeError.as_dict()` of what ended the run.

    Raises
    ------
    ValueError
        For a status or a stage that the contract does not know.
    """
    if status not in STATUSES:
        raise ValueError(f"status {status!r}; expected one of {', '.join(STATUSES)}")
    unknown = set(timings or {}) - set(STAGES)
    if unknown:
        raise ValueError(f"stages {', '.join(sorted(unknown))}; expected some of {', '.join(STAGES)}")
    summary = {
        "schema": SCHEMA,
        "robot": robot,
        "task": task,
        "status": status,
        "segments": [dict(segment) for segment in segments],
        "checks": [check_entry(check) for check in checks],
        "timings_s": {stage: round(float((timings or {}).get(stage, 0.0)), 4) for stage in STAGES},
        "opinions": dict(opinions) if opinions else None,
        "ignored_contacts": dict(ignored_contacts or {}),
        "welded": list(welded),
        "explain": dict(explain) if explain else None,
        "error": {key: error.get(key) for key in ERROR_KEYS} if error else None,
    }
    return dict(plain(summary))


def segment_entry(plan: MotionPlan, measured: float | None = None, name: str | None = None) -> dict[str, Any]:
    """One of `segments`; `measured` is the simulated mean speed [m/s]."""
    table = {"problem": [row.as_dict() for row in plan.report.table]} if plan.report.table else {}
    carried = {"loads": [load.as_dict() for load in plan.loads]} if plan.loads else {}
    return {
        "name": plan.name if name is None else name,
        "kind": plan.kind,
        "limbs_locomotive": list(plan.pattern.locomotive),
        "source": plan.pattern.source,
        "columns": plan.pattern.columns,
        "duration_s": plan.duration,
        "speed_planned_m_s": plan.speed,
        "speed_measured_m_s": measured,
        "solve_s": plan.report.seconds,
        "cost": plan.report.cost,
        "relaxed": [*plan.pattern.relaxed, *plan.relaxed],
        **_refined(plan),
        **carried,
        **table,
    }


def _refined(plan: MotionPlan) -> dict[str, Any]:
    """What the dense check measured, and one entry a solve of refinement; none for a plan that was not optimised."""
    details = plan.report.details
    if "refined" not in details:
        return {}
    measured = {k: v for k, v in details.items() if isinstance(v, (int, float)) and k not in ("rows", "variables")}
    return {"refined": list(details["refined"]), "dense": measured}


def segment_entries(timeline: Timeline, speeds: Sequence[float] = ()) -> list[dict[str, Any]]:
    """`segments` of a timeline, one an entry; `speeds` as in `Verdict.speeds`."""
    measured: list[float | None] = [*speeds, *[None] * (len(timeline.entries) - len(speeds))]
    return [segment_entry(entry.plan, speed) for entry, speed in zip(timeline.entries, measured, strict=True)]


def check_entry(check: Check) -> dict[str, Any]:
    """One of `checks`."""
    return {
        "name": check.name,
        "segment": check.segment,
        "simulator": check.simulator,
        "value": check.value,
        "limit": check.limit,
        "unit": check.unit,
        "passed": bool(check.passed),
    }


def write_summary(path: str | os.PathLike[str], summary: Mapping[str, Any]) -> None:
    """Write ``summary.json`` atomically; InputError when the file cannot be written."""
    write_json(path, plain(summary))


def plain(value: Any) -> Any:
    """JSON types all the way down: NumPy's become Python's, tuples lists, NaN and infinity null."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple, set, frozenset)):
        return [plain(item) for item in (sorted(value) if isinstance(value, (set, frozenset)) else value)]
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value if isinstance(value, (str, int, float, bool)) or value is None else str(value)
