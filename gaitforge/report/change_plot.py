"""Pictures of transitions: bars of speed for few, a matrix of pairs for many."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from gaitforge.report.figures import FAINT, INK, PLANNED, SIMULATED, SWING, new_figure, png

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Row = Mapping[str, Any]
FEW = 12
"""Pairs up to which bars can be read."""
COLOURS = (FAINT, SIMULATED, PLANNED, SWING)


def change_png(rows: Sequence[Row]) -> bytes:
    """PNG of measured transitions: rows as `gaitforge.experiment.judged.change_row` makes them."""
    series = list(dict.fromkeys((r["robot"], r["method"], r["simulator"]) for r in rows))
    pairs = list(dict.fromkeys((r["robot"], r["before"], r["after"]) for r in rows))
    if len(pairs) <= FEW:
        figure = new_figure(1.6 + 1.1 * len(pairs), 3.6)
        _bars(figure.subplots(), rows, pairs)
        figure.tight_layout()
        return png(figure)
    figure = new_figure(4.2 * len(series), 4.2)
    axes = figure.subplots(1, len(series), squeeze=False)[0]
    for ax, one in zip(axes, series, strict=True):
        _matrix(ax, [r for r in rows if (r["robot"], r["method"], r["simulator"]) == one], " · ".join(one))
    figure.tight_layout()
    return png(figure)


def _bars(ax: Axes, rows: Sequence[Row], pairs: list[tuple[str, str, str]]) -> None:
    """Speed [cm/s] by pair, a bar for each method and simulator; falls are marked, published speeds dashed."""
    kinds = list(dict.fromkeys((r["method"], r["simulator"]) for r in rows))
    width = 0.8 / len(kinds)
    for k, kind in enumerate(kinds):
        chosen = [r for r in rows if (r["method"], r["simulator"]) == kind]
        x = [pairs.index((r["robot"], r["before"], r["after"])) + (k - 0.5 * (len(kinds) - 1)) * width for r in chosen]
        ax.bar(x, [100 * r["speed_m_s"] for r in chosen], 0.92 * width, color=COLOURS[k % 4], label=", ".join(kind))
        for at, r in zip(x, chosen, strict=True):
            if r["fallen"]:
                ax.text(at, 0.2, "fallen", rotation=90, ha="center", va="bottom", fontsize=7, color=SWING)
            if r.get("published_m_s") is not None:
                ends = [at - 0.46 * width, at + 0.46 * width]
                ax.plot(ends, [100 * r["published_m_s"]] * 2, color=INK, linewidth=1.2, linestyle=(0, (2, 1)))
    ax.axhline(0.0, color=INK, linewidth=0.8)
    ax.set_xticks(range(len(pairs)), [f"{a} → {b}" for _, a, b in pairs], fontsize=8)
    ax.set_ylabel("mean speed [cm/s]")
    ax.legend(frameon=False, fontsize=8, ncols=len(kinds), loc="lower center", bbox_to_anchor=(0.5, 1.0))
    ax.spines[["top", "right"]].set_visible(False)


def _matrix(ax: Axes, rows: Sequence[Row], title: str) -> None:
    """One cell a pair: green verified, grey unverified, red fallen; the number is the share of speed [%]."""
    names = list(dict.fromkeys([r["before"] for r in rows] + [r["after"] for r in rows]))
    for r in rows:
        i, j = names.index(r["before"]), names.index(r["after"])
        colour = SWING if r["fallen"] else PLANNED if r["verified"] else FAINT
        ax.add_patch(_square(j, i, colour))
        if r["speed_share"] is not None:
            ax.text(j, i, f"{100 * r['speed_share']:.0f}", ha="center", va="center", fontsize=7, color=INK)
    ax.set_xlim(-0.5, len(names) - 0.5)
    ax.set_ylim(len(names) - 0.5, -0.5)
    ax.set_xticks(range(len(names)), names, rotation=90, fontsize=7)
    ax.set_yticks(range(len(names)), names, fontsize=7)
    ax.set_aspect("equal")
    ax.set_title(title, fontsize=8)


def _square(x: float, y: float, colour: str) -> Any:
    from matplotlib.patches import Rectangle

    return Rectangle((x - 0.47, y - 0.47), 0.94, 0.94, color=colour)
