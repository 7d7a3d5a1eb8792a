"""`/verify/report` and `/log`: the judgement, and what happened when."""

from __future__ import annotations

from typing import Any

import numpy as np

from gaitforge.record.archive import segment_names
from gaitforge.record.channels.channel import Channel, boolean, json_channel, number, objects, protobuf_channel, text
from gaitforge.record.run import Run
from gaitforge.verify.verdict import Check

REPORT = {
    "verdict": text("verified · unverified"),
    "simulator": text("the simulator"),
    "failed": number("checks that did not hold"),
    "checks": objects(
        {
            "passed": boolean("did it hold"),
            "name": text("what was checked"),
            "segment": text("in which segment"),
            "value": text("what was found"),
            "limit": text("what was allowed; empty: reported, not judged"),
            "unit": text("unit of both"),
            "simulator": text("by which simulator"),
        },
        "one a question",
    ),
}


def event_channels(run: Run) -> list[Channel]:
    """The report once, and log lines: verdict, failed checks, segments, unplanned contacts."""
    from foxglove_schemas_protobuf.Log_pb2 import Log

    verdict = run.verdict
    report = {
        "verdict": status(run),
        "simulator": " and ".join(verdict.simulators),
        "failed": len(verdict.failed),
        "checks": [_row(check) for check in verdict.checks],
    }
    lines = sorted(_lines(run), key=lambda line: line[0])
    messages = []
    for time, level, message in lines:
        entry = Log(level=level, message=message, name="gaitforge")
        entry.timestamp.seconds, entry.timestamp.nanos = divmod(run.stamp(time), 1_000_000_000)
        messages.append((run.stamp(time), entry))
    return [
        json_channel("/verify/report", "gaitforge.Report", REPORT, [(run.stamp(0.0), report)]),
        protobuf_channel("/log", Log, messages),
    ]


def status(run: Run) -> str:
    """The verdict in one word."""
    return "verified" if run.verdict.passed else "unverified"


def _row(check: Check) -> dict[str, Any]:
    # Values as text: a Table panel shows numbers with all their digits, and a NaN would kill the message.
    limit = "" if check.limit is None else f"{check.limit:.6g}"
    return {
        "passed": bool(check.passed),
        "name": check.name,
        "segment": check.segment,
        "value": f"{check.value:.6g}",
        "limit": limit,
        "unit": check.unit,
        "simulator": check.simulator,
    }


def _lines(run: Run) -> list[tuple[float, Any, str]]:
    """(time [s], level, message)."""
    from foxglove_schemas_protobuf.Log_pb2 import Log

    verdict, timeline = run.verdict, run.timeline
    names = segment_names(timeline)
    starts = {entry.plan.name: entry.start for entry in reversed(timeline.entries)}
    level = Log.INFO if verdict.passed else Log.ERROR
    judged = [check for check in verdict.checks if check.limit is not None or not check.passed]
    counts = f"{sum(check.passed for check in judged)} of {len(judged)} checks hold"
    lines = [(0.0, level, f"{status(run)} in {' and '.join(verdict.simulators)}: {counts}")]
    for check in verdict.failed:
        limit = "" if check.limit is None else f", limit {check.limit:.4g}"
        where = f" in {check.simulator}" if verdict.others else ""
        message = f"{check.segment}: {check.name} {check.value:.4g} {check.unit}{limit}{where}"
        lines.append((starts.get(check.segment, 0.0), Log.ERROR, message))
    for name, entry in zip(names, timeline.entries, strict=True):
        plan = entry.plan
        repeated = f" × {entry.cycles}" if entry.cycles > 1 else ""
        message = f"{plan.kind} {name}{repeated}: {len(plan.pattern.locomotive)} limbs walk, {plan.speed:.3f} m/s"
        lines.append((entry.start, Log.INFO, message))
    for event in run.trace.unplanned:
        force = f", {event.force:.1f} N" if np.isfinite(event.force) else ""
        lines.append((event.time, Log.WARNING, f"unplanned contact: {event.what}{force}"))
    return [(min(max(time, 0.0), timeline.duration), level, message) for time, level, message in lines]
