"""Footfall patterns side by side, as in the paper's figure 3: red boxes swing, white ones stance."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.report.figures import FAINT, INK, STANCE, SWING, new_figure, png

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BOX, LEFT, TOP, BELOW, MARGIN = 0.2, 0.45, 0.5, 0.25, 0.15
"""[in] a box, room for limb names, for titles, for column numbers, around the picture"""
NARROWEST = 14
"""[columns] room that a pattern takes at least, for its title"""


def candidates_png(patterns: Sequence[tuple[str, str, FootfallPattern]], across: int = 2) -> bytes:
    """Patterns in rows of `across`, each with a title and a line of details below it; as PNG."""
    wide = max(NARROWEST, *(p.columns for _, _, p in patterns)) * BOX + LEFT
    high = max(len(p.limbs) for _, _, p in patterns) * BOX + TOP + BELOW
    lines = -(-len(patterns) // across)
    width, height = MARGIN + across * (wide + MARGIN), lines * high + MARGIN
    figure = new_figure(width, height)
    for k, (title, details, pattern) in enumerate(patterns):
        x = MARGIN + LEFT + (k % across) * (wide + MARGIN)
        rows, columns = pattern.contact.shape
        bottom = height - (k // across) * high - TOP - rows * BOX
        box = (x / width, bottom / height, columns * BOX / width, rows * BOX / height)
        _draw(figure.add_axes(box), title, details, pattern)
    return png(figure)


def _draw(axes: Axes, title: str, details: str, pattern: FootfallPattern) -> None:
    from matplotlib.patches import Rectangle

    rows, columns = pattern.contact.shape
    for i in range(rows):
        for j in range(columns):
            color = STANCE if pattern.contact[i, j] else SWING
            axes.add_patch(Rectangle((j, i), 1, 1, facecolor=color, edgecolor=INK, linewidth=0.7))
    axes.set_xlim(0, columns)
    axes.set_ylim(rows, 0)
    axes.set_yticks([i + 0.5 for i in range(rows)], pattern.limbs, fontsize=7, color=INK)
    axes.set_xticks([j + 0.5 for j in range(columns)], [str(j + 1) for j in range(columns)], fontsize=6, color=FAINT)
    axes.tick_params(length=0, pad=2)
    for label, limb in zip(axes.get_yticklabels(), pattern.limbs, strict=True):
        label.set_color(INK if limb in pattern.locomotive else SWING)
    axes.set_title(details, loc="left", fontsize=6, color=FAINT, pad=3)
    axes.annotate(title, (0, 1), (0, 13), "axes fraction", "offset points", fontsize=8, color=INK, weight="bold")
