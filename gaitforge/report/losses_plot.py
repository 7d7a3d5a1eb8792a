"""What lost limbs come to: one bar for every robot and number of limbs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from gaitforge.report.figures import FAINT, PLANNED, SWING, new_figure, png

COLORS = {"verified": PLANNED, "infeasible": FAINT, "unverified": SWING}


def losses_png(rows: Sequence[Mapping[str, Any]]) -> bytes:
    """PNG of how many rows have which status, by robot, mode and number of lost limbs."""
    groups = list(dict.fromkeys((r["robot"], r["mode"], r["lost"]) for r in rows))
    counts = Counter((r["robot"], r["mode"], r["lost"], r["status"]) for r in rows)
    figure = new_figure(7.0, 0.9 + 0.4 * len(groups))
    axes = figure.subplots()
    left = [0] * len(groups)
    for status, color in COLORS.items():
        widths = [counts[*group, status] for group in groups]
        axes.barh(range(len(groups)), widths, left=left, color=color, label=status)
        left = [a + b for a, b in zip(left, widths, strict=True)]
    axes.set_yticks(range(len(groups)), [f"{robot}, {lost} {mode}" for robot, mode, lost in groups])
    axes.invert_yaxis()
    axes.set_xlabel("subsets of limbs [-]")
    axes.legend(loc="lower right", frameon=False)
    figure.tight_layout()
    return png(figure)
