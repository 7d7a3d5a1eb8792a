"""Tables of plain text for terminals, from what stands in ``summary.json``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any


def table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Columns as wide as their widest cell; numbers to the right."""
    cells = [list(header), *(list(row) for row in rows)]
    widths = [max(len(row[k]) for row in cells) for k in range(len(header))]
    right = [bool(rows) and all(_is_number(row[k]) for row in rows) for k in range(len(header))]
    lines = [
        "  ".join(c.rjust(w) if r else c.ljust(w) for c, w, r in zip(row, widths, right, strict=True)).rstrip()
        for row in cells
    ]
    return "\n".join([lines[0], "  ".join("─" * w for w in widths), *lines[1:]])


def segments_text(summary: Mapping[str, Any]) -> str:
    """Gaits, transitions and stands with planned and measured speed."""
    header = (
        "segment",
        "kind",
        "limbs",
        "source",
        "columns",
        "time [s]",
        "solves",
        "planned [cm/s]",
        "measured [cm/s]",
    )
    rows = [
        (
            segment["name"],
            segment["kind"],
            str(len(segment["limbs_locomotive"])),
            segment["source"],
            str(segment["columns"]),
            f"{segment['duration_s']:.2f}",
            _solves(segment),
            _cm(segment["speed_planned_m_s"]),
            _cm(segment["speed_measured_m_s"]),
        )
        for segment in summary["segments"]
    ]
    return table(header, rows)


def checks_text(summary: Mapping[str, Any], *, failed_only: bool = False) -> str:
    """What was asked of the simulated run, and the answers."""
    several = summary["opinions"] is not None
    header = ("", "check", "segment", "value", "limit", "unit", *(["simulator"] if several else []))
    rows = [
        (
            mark(check),
            check["name"],
            check["segment"],
            number(check["value"]),
            number(check["limit"]),
            check["unit"],
            *([check["simulator"]] if several else []),
        )
        for check in summary["checks"]
        if not (failed_only and check["passed"])
    ]
    return table(header, rows)


def opinions_text(summary: Mapping[str, Any]) -> str:
    """What each simulator says, where they disagree, and by how much their speeds differ; empty when one was asked."""
    said = summary["opinions"]
    if said is None:
        return ""
    verdicts = ", ".join(f"{name} {'verifies' if passed else 'does not'}" for name, passed in said["passed"].items())
    differing = max(said["speeds_m_s"], key=lambda s: s["difference"] or 0.0)
    by = f"{100 * (differing['difference'] or 0.0):.3f} cm/s ({differing['segment']})"
    lines = [f"{verdicts}; speeds differ by at most {by}; disagreements: {len(said['disagreements']) or 'none'}"]
    for found in said["disagreements"]:
        values = ", ".join(
            f"{name} {number(value)} ({'holds' if found['passed'][name] else 'fails'})"
            for name, value in found["values"].items()
        )
        lines.append(f"  {found['name']} of {found['segment']}: {values}")
    return "\n".join(lines)


def ignored_text(summary: Mapping[str, Any]) -> str:
    """Which links were let through each other, one line a simulator; empty when none were."""
    return "\n".join(
        f"{simulator}: contacts ignored of links that overlap in the nominal posture: "
        + ", ".join(" and ".join(pair) for pair in pairs)
        for simulator, pairs in summary["ignored_contacts"].items()
    )


def welded_text(summary: Mapping[str, Any]) -> str:
    """What a weld held, where friction would have had to; empty when nothing was welded."""
    return f"held by a weld, not by friction: {', '.join(summary['welded'])}" if summary["welded"] else ""


def problem_text(rows: Sequence[Mapping[str, Any]]) -> str:
    """What a motion problem consisted of, by family."""
    header = ("family", "kind", "rows", "variables", "instances", "at a bound [%]", "cost", "enforced")
    return table(header, [problem_cells(row) for row in rows])


def problem_cells(row: Mapping[str, Any]) -> tuple[str, ...]:
    """One row of the problem table, as text."""
    active = "–" if row["active"] is None else f"{100 * row['active']:.0f}"
    counts = (str(row[key]) for key in ("rows", "variables", "instances"))
    return (row["family"], row["kind"], *counts, active, number(row["cost"]), row["enforced"])


def mark(check: Mapping[str, Any]) -> str:
    """✓ held · ✗ did not · "·" was reported only."""
    if not check["passed"]:
        return "✗"
    return "·" if check["limit"] is None else "✓"


def number(value: float | None) -> str:
    """Four digits, or a dash for what is not there."""
    return "–" if value is None else f"{value:.4g}"


def _solves(segment: Mapping[str, Any]) -> str:
    """How many solves a plan took, and which families asked for more than one."""
    refined = segment.get("refined", [])
    asked = list(dict.fromkeys(family for entry in refined for family in entry["for"]))
    return f"{len(refined)}" + (f" ({', '.join(asked)})" if asked else "") if refined else "–"


def _cm(speed: float | None) -> str:
    return "–" if speed is None else f"{100 * speed:.2f}"


def _is_number(cell: str) -> bool:
    return cell == "–" or cell.replace(".", "", 1).replace("-", "", 1).replace("e", "", 1).isdigit()
