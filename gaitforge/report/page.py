"""``report.html``: one page that shows a run and needs nothing but itself."""

from __future__ import annotations

import base64
import os
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from gaitforge.record.files import write_text
from gaitforge.report.text import ignored_text, mark, number, opinions_text, problem_cells, welded_text

STYLE = """
:root { color-scheme: light; }
body { font: 15px/1.5 system-ui, sans-serif; color: #30363c; background: #fbfcfd; margin: 0 auto;
       max-width: 66rem; padding: 2rem 1.2rem 4rem; }
h1 { font-size: 1.6rem; margin: 0 0 .2rem; } h2 { font-size: 1.1rem; margin: 2.2rem 0 .6rem; }
.verdict { display: inline-block; padding: .25rem .8rem; border-radius: 1rem; color: #fff; font-weight: 600; }
.verified { background: #2f7d4f; } .unverified, .error { background: #b3261e; }
.infeasible, .unsolved { background: #8a5a00; }
.sub { color: #6b757e; margin: .4rem 0 0; }
table { border-collapse: collapse; font-size: .88rem; width: 100%; background: #fff; }
th, td { text-align: left; padding: .3rem .6rem; border-bottom: 1px solid #e3e7ea; }
th { color: #6b757e; font-weight: 600; border-bottom-color: #c5ccd2; }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; }
tr.failed td { background: #fdecea; } tr.reported td { color: #6b757e; }
img { max-width: 100%; height: auto; border: 1px solid #e3e7ea; background: #fff; }
.pictures { display: grid; grid-template-columns: repeat(auto-fit, minmax(24rem, 1fr)); gap: .8rem; }
figure { margin: 0; } figcaption { color: #6b757e; font-size: .85rem; }
code, pre { font: .88rem ui-monospace, monospace; background: #eef1f4; border-radius: .25rem; }
code { padding: .1rem .3rem; } pre { padding: .8rem; overflow-x: auto; white-space: pre-wrap; }
details summary { cursor: pointer; color: #6b757e; margin-top: .4rem; }
"""

CLASH = "What the families ask of the cells of C: blue has to be in stance, red in swing, pale cells in part"


def write_report_html(
    path: str | os.PathLike[str],
    summary: Mapping[str, Any],
    *,
    footfall_png: bytes | None = None,
    speed_png: bytes | None = None,
    clash_png: bytes | None = None,
    pictures: Sequence[tuple[str, bytes]] = (),
    clip: str | None = None,
    log: str = "run.mcap",
    layout: str = "run.layout.json",
) -> None:
    """Write the page, atomically.

    Parameters
    ----------
    summary
        As in ``summary.json``.
    pictures
        (caption, PNG) of the simulation.
    clip
        Name of an animated picture beside the page; None: there is none.
    log, layout
        Names of the files beside the page.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    plots = (("Footfall patterns: red boxes swing, white boxes stance; one cycle of each gait", footfall_png),)
    speed = (("Forward speed, planned and simulated", speed_png),)
    body = [
        _head(summary),
        _images("Simulation", [p for p in pictures if p[1]]),
        _clip(clip) if clip else "",
        _segments(summary["segments"]),
        _images("Speed", [(caption, png) for caption, png in speed if png]),
        _images("Footfall", [(caption, png) for caption, png in plots if png]),
        _text("Second opinion", opinions_text(summary).splitlines()) if summary["opinions"] else "",
        _checks(summary["checks"]),
        _text("Welded grasp", [welded_text(summary)]) if summary["welded"] else "",
        _text("Ignored contacts", ignored_text(summary).splitlines()) if summary["ignored_contacts"] else "",
        _problems(summary["segments"]),
        _explain(summary),
        _images("What clashes", [(CLASH, clash_png)] if clash_png else []),
        _timings(summary["timings_s"]),
        _how_to_open(log, layout) if summary["checks"] else "",
    ]
    title = escape(f"{summary['robot']} · {summary['task']}")
    write_text(
        path,
        f'<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta name="viewport" content="width=device-width, initial-scale=1">\n<title>{title}</title>\n'
        f"<style>{STYLE}</style>\n</head>\n<body>\n"
        + "\n".join(part for part in body if part)
        + "\n</body>\n</html>\n",
    )


def _head(summary: Mapping[str, Any]) -> str:
    judged = [check for check in summary["checks"] if check["limit"] is not None]
    held = sum(check["passed"] for check in judged)
    simulators = ", ".join(sorted({check["simulator"] for check in summary["checks"]}))
    counts = f"{held} of {len(judged)} checks hold in {escape(simulators)}" if judged else "nothing was simulated"
    status = escape(str(summary["status"]))
    return (
        f"<h1>{escape(summary['robot'])} · {escape(summary['task'])}</h1>\n"
        f'<span class="verdict {status}">{status}</span>\n<p class="sub">{counts}</p>'
    )


def _segments(segments: Sequence[Mapping[str, Any]]) -> str:
    if not segments:
        return ""
    rows = [
        [
            _cell(s["name"]),
            _cell(s["kind"]),
            _cell(f"{len(s['limbs_locomotive'])}: {' '.join(s['limbs_locomotive'])}"),
            _cell(s["source"]),
            _cell(s["columns"], True),
            _cell(f"{s['duration_s']:.2f}", True),
            _cell(_cm(s["speed_planned_m_s"]), True),
            _cell(_cm(s["speed_measured_m_s"]), True),
            _cell("; ".join(s["relaxed"]) or "–"),
        ]
        for s in segments
    ]
    header = ("segment", "kind", "limbs that walk", "source", "#columns", "#T [s]", "#planned [cm/s]")
    return "<h2>Gaits and transitions</h2>\n" + _table((*header, "#measured [cm/s]", "relaxed"), rows)


def _checks(checks: Sequence[Mapping[str, Any]]) -> str:
    if not checks:
        return ""
    header = ("", "check", "segment", "#value", "#limit", "unit", "simulator")
    judged = [check for check in checks if check["limit"] is not None or not check["passed"]]
    reported = [check for check in checks if check["limit"] is None and check["passed"]]
    page = "<h2>Checks</h2>\n" + _table(header, [_check(c) for c in judged], [_class(c) for c in judged])
    if reported:
        rows = _table(header, [_check(c) for c in reported], [_class(c) for c in reported])
        page += f"\n<details><summary>{len(reported)} more values, reported but not judged</summary>\n{rows}</details>"
    return page


def _check(check: Mapping[str, Any]) -> list[str]:
    cells = [_cell(mark(check)), _cell(check["name"].replace("_", " ")), _cell(check["segment"])]
    values = [_cell(number(check["value"]), True), _cell(number(check["limit"]), True), _cell(check["unit"])]
    return [*cells, *values, _cell(check["simulator"])]


def _class(check: Mapping[str, Any]) -> str:
    return {"✗": "failed", "·": "reported"}.get(mark(check), "")


def _problems(segments: Sequence[Mapping[str, Any]]) -> str:
    header = ("family", "kind", "#rows", "#variables", "#instances", "#at a bound [%]", "#cost", "enforced")
    parts = []
    for segment in segments:
        if segment.get("problem"):
            cells = [problem_cells(row) for row in segment["problem"]]
            rows = [[_cell(text, h[0] == "#") for text, h in zip(row, header, strict=True)] for row in cells]
            summary = f"<summary>{escape(segment['name'])}</summary>"
            parts.append(f"<details>{summary}\n{_table(header, rows)}</details>")
    return "<h2>Motion problems</h2>\n" + "\n".join(parts) if parts else ""


def _explain(summary: Mapping[str, Any]) -> str:
    parts = []
    if summary["error"]:
        error = summary["error"]
        lines = [f"{key}: {error[key]}" for key in ("type", "file", "key", "found", "expected") if error[key]]
        parts.append(_text("Error", lines))
    if summary["explain"]:
        said = [(key, value) for key, value in summary["explain"].items() if key not in ("demands", "pattern")]
        parts.append(_text("Why", [f"{key}: {value}" for key, value in said]))
    return "".join(parts)


def _text(title: str, lines: Sequence[str]) -> str:
    return f"<h2>{title}</h2>\n<pre>{escape(chr(10).join(lines))}</pre>\n"


def _timings(timings: Mapping[str, float]) -> str:
    rows = [[_cell(f"{timings[stage]:.2f}", True) for stage in timings]]
    return "<h2>Seconds of computing</h2>\n" + _table([f"#{stage}" for stage in timings], rows)


def _how_to_open(log: str, layout: str) -> str:
    return (
        "<h2>Replay</h2>\n<p>Open <code>" + escape(log) + "</code> in Foxglove or Lichtblick "
        "(<em>Open local file</em>), then import <code>" + escape(layout) + "</code> from the layout menu "
        "(<em>Import from file</em>): without the layout a viewer shows axes and no robot. The solid robot is the "
        "simulated one, the green ghost the plan. The log also holds every pattern C and motion plan P exactly; "
        "<code>gaitforge.record.reader.read_run</code> gives them back, ready to be executed.</p>"
    )


def _images(title: str, images: Sequence[tuple[str, bytes]]) -> str:
    if not images:
        return ""
    figures = [
        f'<figure><img alt="{escape(caption)}" src="data:image/png;base64,{base64.b64encode(png).decode()}">'
        f"<figcaption>{escape(caption)}</figcaption></figure>"
        for caption, png in images
    ]
    grid = ' class="pictures"' if len(images) > 1 else ""
    return f"<h2>{title}</h2>\n<div{grid}>" + "\n".join(figures) + "</div>"


def _clip(name: str) -> str:
    return f'<h2>Clip</h2>\n<figure><img alt="The whole run, as fast as it went" src="{escape(name)}"></figure>'


def _table(header: Sequence[str], rows: Sequence[Sequence[str]], classes: Sequence[str] = ()) -> str:
    head = "".join(f'<th class="n">{escape(h[1:])}</th>' if h[:1] == "#" else f"<th>{escape(h)}</th>" for h in header)
    names = classes or [""] * len(rows)
    body = "\n".join(
        f'<tr class="{name}">{"".join(row)}</tr>' if name else f"<tr>{''.join(row)}</tr>"
        for name, row in zip(names, rows, strict=True)
    )
    return f"<table>\n<tr>{head}</tr>\n{body}\n</table>"


def _cell(value: object, numeric: bool = False) -> str:
    return f'<td class="n">{escape(str(value))}</td>' if numeric else f"<td>{escape(str(value))}</td>"


def _cm(speed: float | None) -> str:
    return "–" if speed is None else f"{100 * speed:.2f}"
