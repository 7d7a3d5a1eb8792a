"""docs/results/commands.md and its pictures, from the rows of `benchmarks.commands`."""

from __future__ import annotations

import datetime
import platform
from collections.abc import Iterator, Sequence
from importlib.metadata import version
from pathlib import Path

import numpy as np

from benchmarks.commands_cases import (
    CYCLES,
    ITERATIONS,
    STILL_MM_S,
    VELOCITY_PERCENT,
    YAW_LIMIT_DEG_S,
    Row,
)

RESULTS = Path(__file__).parents[1] / "docs" / "results"


def write_page(rows: Sequence[Row]) -> Path:
    """Write the page and a polar plot for each robot; the page's path."""
    from gaitforge.record.files import write_bytes, write_text

    robots = list(dict.fromkeys(row.case.robot for row in rows))
    (RESULTS / "images").mkdir(parents=True, exist_ok=True)
    for name in robots:
        write_bytes(RESULTS / "images" / f"commands_{name}.png", _plot([r for r in rows if r.case.robot == name]))
    page = RESULTS / "commands.md"
    write_text(page, "\n".join(_lines(rows, robots)))
    return page


def _lines(rows: Sequence[Row], robots: Sequence[str]) -> Iterator[str]:
    versions = ", ".join(f"{p} {version(p)}" for p in ("pin", "casadi", "numpy", "pybullet"))
    today = datetime.date.today().isoformat()
    yield "# Commands"
    yield ""
    yield (
        f"`OMP_NUM_THREADS=1 python -m benchmarks.commands`, {today}, Python {platform.python_version()}, {versions}; "
        f"{platform.machine()}. Alternating tripod, default options; {CYCLES} cycles in PyBullet between a start and "
        "a stop, the first cycle left out."
    )
    yield ""
    yield (
        f"*walks*: the mean velocity, a vector in the frame of the body, is within {VELOCITY_PERCENT:g} % of the "
        f"command (on the spot: within {STILL_MM_S:g} mm/s of standing still) and the yaw rate within "
        f"{YAW_LIMIT_DEG_S:g} °/s, and the robot does not fall. *refused*: there is no plan, and the error says why. "
        "Other checks of the simulated gait that fail stand beside it."
    )
    yield ""
    yield from _summary(rows, robots)
    for name in robots:
        own = [row for row in rows if row.case.robot == name]
        yield from (f"## {name}", "", f"![velocities](images/commands_{name}.png)", "")
        yield from _table(own)
    yield from _turning([row for row in rows if row.status != "refused" and row.case.yaw_deg_s])
    refused = [row for row in rows if row.status == "refused"]
    if refused:
        yield from ("## Refusals", "")
        yield from (f"- {_name(row)} ({row.case.robot}): {row.why}" for row in refused)
        yield ""


def _summary(rows: Sequence[Row], robots: Sequence[str]) -> Iterator[str]:
    yield "| robot | cases | feasible | of these walk | worst velocity error [%] | … yaw rate [°/s] | plan [s] |"
    yield "|---|---|---|---|---|---|---|"
    for name in robots:
        own = [row for row in rows if row.case.robot == name]
        planned = [row for row in own if row.status != "refused"]
        walks = sum(row.status == "walks" for row in planned)
        percent = max((row.velocity_percent for row in planned if row.velocity_percent is not None), default=0.0)
        yaw = max((row.yaw_error_deg_s or 0.0 for row in planned), default=0.0)
        seconds = np.median([row.plan_s for row in planned]) if planned else 0.0
        yield f"| {name} | {len(own)} | {len(planned)} | {walks} | {percent:.1f} | {yaw:.2f} | {seconds:.1f} |"
    yield ""


def _table(rows: Sequence[Row]) -> Iterator[str]:
    yield (
        "| command | | velocity error | yaw rate [°/s] | joint speed | torque planned, simulated | ZMP margin [mm] | "
        "slip [mm] | tilt [°] | height [mm] | lift [mm] | other checks, relaxed |"
    )
    yield "|---|---|---|---|---|---|---|---|---|---|---|---|"
    for row in rows:
        if row.status == "refused":
            yield f"| {_name(row)} | refused | | | | | | | | | | {', '.join(row.families)} |"
            continue
        v = row.values
        error = f"{row.velocity_mm_s:.1f} mm/s" if row.velocity_percent is None else f"{row.velocity_percent:.1f} %"
        notes = ", ".join((*row.failed, *([row.why] if row.why else [])))
        cells = (
            _name(row), row.status, error, f"{row.yaw_error_deg_s:.2f}", f"{v['speed_ratio']:.2f}",
            f"{v['effort_planned']:.2f}, {v['effort_measured']:.2f}", f"{v['zmp_margin_mm']:.0f}",
            f"{v['slip_mm']:.1f}", f"{v['tilt_deg']:.2f}", f"{1e3 * v['height_m']:.0f}", f"{v['lift_mm']:.0f}", notes,
        )  # fmt: skip
        yield "| " + " | ".join(cells) + " |"
    yield ""


def _turning(rows: Sequence[Row]) -> Iterator[str]:
    """How much of the slip of turning gaits is the contact solver's."""
    yield "## Turning, and the contact solver"
    yield ""
    yield (
        "A foot that turns on its spot creeps in PyBullet's contact solver as long as that has not converged, with a "
        f"friction far below its limit; the same gaits with {ITERATIONS} iterations in every step:"
    )
    yield ""
    yield "| robot | command | slip [mm] | … converged | velocity [mm/s] | … converged | yaw rate [°/s] | … converged |"
    yield "|---|---|---|---|---|---|---|---|"
    for row in rows:
        v = row.values
        yield (
            f"| {row.case.robot} | {_name(row)} | {v['slip_mm']:.1f} | {v['slip_converged_mm']:.1f} | "
            f"{row.velocity_mm_s:.1f} | {v['velocity_converged_mm_s']:.1f} | {row.yaw_error_deg_s:.2f} | "
            f"{v['yaw_converged_deg_s']:.2f} |"
        )
    yield ""


def _name(row: Row) -> str:
    case = row.case
    if case.group == "velocity":
        return f"{100 * case.speed:g} cm/s at {case.heading_deg:g}°"
    if case.group in ("on the spot", "along an arc"):
        return f"{case.group}, {case.yaw_deg_s:+g} °/s" + (f", {100 * case.speed:g} cm/s" if case.speed else "")
    if case.group == "body height":
        return f"body at {1e3 * (case.body_height or 0.0):.0f} mm, {100 * case.speed:g} cm/s"
    return f"steps of {1e3 * (case.step_height or 0.0):.0f} mm, {100 * case.speed:g} cm/s"


def _plot(rows: Sequence[Row]) -> bytes:
    """Commanded velocities as rings, measured errors as colours, refusals as crosses."""
    from gaitforge.report.figures import INK, new_figure, png

    figure = new_figure(6.4, 5.6)
    axes = figure.add_subplot(projection="polar")
    axes.set_theta_zero_location("N")  # type: ignore[attr-defined]
    pairs = [row for row in rows if row.case.group == "velocity"]
    walked = [row for row in pairs if row.velocity_percent is not None]
    angle = [np.radians(row.case.heading_deg) for row in walked]
    speed = [100 * row.case.speed for row in walked]
    shown = axes.scatter(
        angle, speed, c=[row.velocity_percent for row in walked], cmap="viridis_r", vmin=0.0, vmax=VELOCITY_PERCENT,
        s=130, edgecolors=INK, linewidths=0.6,
    )  # fmt: skip
    for row in pairs:
        if row.status == "refused":
            axes.plot(np.radians(row.case.heading_deg), 100 * row.case.speed, "x", color="#b3261e", markersize=11)
    axes.set_rlim(0, 100 * max((row.case.speed for row in pairs), default=0.1) * 1.12)  # type: ignore[attr-defined]
    axes.set_title("heading and speed [cm/s], ahead is up", color=INK, fontsize=10)
    figure.colorbar(shown, ax=axes, shrink=0.75, pad=0.1, label="velocity error [%]")
    return png(figure)
