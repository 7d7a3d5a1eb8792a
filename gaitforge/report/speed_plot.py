"""Planned against simulated forward speed over time."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import numpy as np

from gaitforge.motion.timeline import Timeline
from gaitforge.record.derived import column_seconds, cycle_seconds, forward_speed, travel_direction
from gaitforge.record.files import write_bytes
from gaitforge.report.figures import FAINT, INK, PLANNED, SHADES, SIMULATED, new_figure, png
from gaitforge.verify.verdict import Verdict

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def write_speed_png(path: str | os.PathLike[str], verdict: Verdict) -> None:
    """Draw the speed along the commanded direction as moving averages; InputError when it cannot be written."""
    write_bytes(path, speed_png(verdict))


def speed_png(verdict: Verdict) -> bytes:
    """The picture as PNG: thin lines average over a column, thick ones over a repetition of the segment."""
    trace, timeline = verdict.trace, verdict.timeline
    direction = travel_direction(timeline, trace)
    column, cycle = column_seconds(timeline, trace), cycle_seconds(timeline, trace)
    figure = new_figure(9.0, 3.8)
    axes = figure.add_axes((0.07, 0.2, 0.88, 0.55))
    for poses, color, label, thin, thick in (  # the plan is drawn wider: a good run hides it otherwise
        (trace.plan.base_poses, PLANNED, "planned", 1.6, 5.0),
        (trace.base_poses, SIMULATED, f"simulated ({verdict.simulator})", 0.7, 1.6),
    ):
        fast, slow = (100 * forward_speed(poses, direction, trace.times, window) for window in (column, cycle))
        axes.plot(trace.times, fast, color=color, linewidth=thin, alpha=0.6, label=f"{label}, mean over a column")
        axes.plot(trace.times, slow, color=color, linewidth=thick, label=f"{label}, mean over a cycle")
    _segments(axes, timeline, verdict.speeds)
    axes.axhline(0.0, color=FAINT, linewidth=0.6)
    axes.set_xlim(0.0, timeline.duration)
    axes.margins(y=0.08)
    axes.set_xlabel("time [s]", fontsize=8, color=INK)
    axes.set_ylabel("forward speed [cm/s]", fontsize=8, color=INK)
    axes.tick_params(labelsize=7, colors=INK)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    figure.legend(*axes.get_legend_handles_labels(), loc="lower center", ncols=4, fontsize=7, frameon=False)
    return png(figure)


def _segments(axes: Axes, timeline: Timeline, speeds: tuple[float, ...]) -> None:
    """Shade every segment, name it, and write planned → measured speed above it."""
    top = axes.get_xaxis_transform()
    for k, entry in enumerate(timeline.entries):
        axes.axvspan(entry.start, entry.end, color=SHADES[entry.plan.kind], linewidth=0, zorder=0)
        middle, level = 0.5 * (entry.start + entry.end), 1.02
        measured = speeds[k] if k < len(speeds) else np.nan
        found = f" → {100 * measured:.2f}" if np.isfinite(measured) else ""
        text = f"{entry.plan.name}\n{100 * entry.plan.speed:.2f}{found}"
        wide = (entry.end - entry.start) / timeline.duration > 0.012 * len(entry.plan.name)
        axes.text(
            middle,
            level,
            text,
            transform=top,
            ha="center" if wide else "left",
            va="bottom",
            rotation=0 if wide else 35,
            fontsize=7 if wide else 6,
            color=INK,
        )
