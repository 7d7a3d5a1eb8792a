"""What lost limbs come to: one bar for every robot, number of limbs and simulator."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from gaitforge.report.figures import BOUNDARY_SWING, FAINT, INK, PLANNED, SWING, new_figure, png

COLORS = {"verified": PLANNED, "infeasible": FAINT, "unverified": SWING, "unsolved": BOUNDARY_SWING, "error": INK}


def losses_png(rows: Sequence[Mapping[str, Any]]) -> bytes:
    """PNG of the share of rows that have each status, by robot, mode, number of lost limbs and simulator.

    A row without a simulator, one that is infeasible say, counts in the bar of each of those that its robot and mode
    were judged by.
    """
    bars = _counted(rows)
    figure = new_figure(7.0, 0.9 + 0.4 * len(bars))
    axes = figure.subplots()
    left = [0.0] * len(bars)
    for status, color in COLORS.items():
        if not any(count[status] for count in bars.values()):
            continue
        widths = [100.0 * count[status] / count.total() for count in bars.values()]
        drawn = axes.barh(range(len(bars)), widths, left=left, color=color, label=status)
        axes.bar_label(drawn, [str(count[status] or "") for count in bars.values()], label_type="center", fontsize=8)
        left = [a + b for a, b in zip(left, widths, strict=True)]
    axes.set_yticks(range(len(bars)), list(bars))
    axes.invert_yaxis()
    axes.set_xlabel("subsets of limbs [%], and their number")
    axes.legend(loc="lower center", bbox_to_anchor=(0.4, 1.0), ncols=len(COLORS), frameon=False)
    figure.tight_layout()
    return png(figure)


def _counted(rows: Sequence[Mapping[str, Any]]) -> dict[str, Counter[str]]:
    """Label of a bar → how many of its rows have which status."""
    named = [(r["robot"], r["mode"], r["simulator"]) for r in rows if r.get("simulator")]
    several = len({simulator for *_, simulator in named}) > 1
    bars: dict[str, Counter[str]] = {}
    for row in rows:
        label = f"{row['robot']}, {row['lost']} {row['mode']}"
        asked = dict.fromkeys(s for robot, mode, s in named if (robot, mode) == (row["robot"], row["mode"]))
        for simulator in [row["simulator"]] if row.get("simulator") else [*asked] or [None]:
            key = f"{label}, {simulator}" if several and simulator else label
            bars.setdefault(key, Counter())[row["status"]] += 1
    return bars
