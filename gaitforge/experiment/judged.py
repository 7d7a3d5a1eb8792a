"""What a simulated transition comes to, as one row."""

from __future__ import annotations

from typing import Any

from gaitforge.motion.transition import mean_command
from gaitforge.pipeline.search.segment import Segment
from gaitforge.verify.verdict import Check, Verdict


def change_row(verdict: Verdict, change: Segment) -> dict[str, Any]:
    """Values of the transition itself (docs/experiments.md); *fallen* and *verified* speak of the whole run.

    ``speed_m_s`` is the mean speed along the planned direction, ``speed_share`` that of the speed commanded:
    the mean of both gaits' velocities.
    """
    entries = verdict.timeline.entries
    index = next(i for i, e in enumerate(entries) if e.plan is change.plan)
    plan, speed = change.plan, verdict.speeds[index]
    here = {c.name: c for c in verdict.checks if c.segment == plan.name}
    commanded = mean_command(entries[index - 1].plan.command, entries[index + 1].plan.command).speed
    gaits = {e.plan.name for e in entries if e.plan.kind == "gait"}
    fallen = [c for c in verdict.checks if c.name == "fallen"]
    return {
        "status": "verified" if verdict.passed else "unverified",
        "verified": verdict.passed,
        "fallen": not all(c.passed for c in fallen),
        "speed_m_s": speed,
        "speed_planned_m_s": plan.speed,
        "speed_share": speed / commanded if commanded > 0.0 else None,
        "heading_deg": _value(here, "heading"),
        "tilt_deg": _value(here, "tilt"),
        "tilt_worst_deg": max(c.value for c in fallen),
        "margin_m": _metres(here, "static_margin"),
        "gait_margin_m": min(
            c.value / 1000.0 for c in verdict.checks if c.name == "static_margin" and c.segment in gaits
        ),
        "slip_m": _metres(here, "slip"),
        "unplanned": int(_value(here, "unplanned_contact") or 0),
        "failed": [f"{c.segment}: {c.name} {c.value:.3g} {c.unit}" for c in verdict.failed],
        "columns": plan.pattern.columns,
        "duration_s": plan.duration,
        "source": plan.pattern.source,
        "relaxed": [*plan.pattern.relaxed, *plan.relaxed],
        "tries": 1 + len(change.left),
        "solve_s": plan.report.seconds,
    }


def _value(checks: dict[str, Check], name: str) -> float | None:
    return checks[name].value if name in checks else None


def _metres(checks: dict[str, Check], name: str) -> float | None:
    return checks[name].value / 1000.0 if name in checks else None
