"""Why there is no pattern, as a picture: what each of the clashing families asks of the cells of C."""

from __future__ import annotations

import os
import textwrap
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from gaitforge.record.files import write_bytes
from gaitforge.report.figures import BOUNDARY, FAINT, INK, SIMULATED, STANCE, SWING, new_figure, png

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BOX, LEFT, GAP, TOP, MARGIN, LINE = 0.2, 0.5, 0.35, 0.5, 0.2, 0.17
"""[in] a cell, room for limb names, between panels, above them, around the picture, a line of text"""
SOME_STANCE, SOME_SWING, ORDER = "#c3d4ec", "#f4cdcb", "#e9e4d4"
"""Cells of which some have to be in stance, in swing; cells with an order to keep."""
NARROWEST = 14
"""[columns] room that a panel takes at least, for its sentences"""


def write_clash_png(path: str | os.PathLike[str], explain: Mapping[str, Any]) -> bool:
    """Draw `explain` of an infeasible pattern; False, and no file, when it holds no demands to draw."""
    if not explain.get("demands") or not explain.get("pattern"):
        return False
    write_bytes(path, clash_png(explain))
    return True


def clash_png(explain: Mapping[str, Any]) -> bytes:
    """One panel a family, limbs × columns: blue cells have to be in stance, red ones in swing.

    Where only some of the cells have to be, all of them are pale and as many as have to be are full.
    """
    pattern = explain["pattern"]
    panels = _by_family(explain["demands"])
    wide = max(NARROWEST, pattern["columns"]) * BOX
    rows = len(pattern["limbs"]) * BOX
    sentences = [_sentences(demands, wide) for demands in panels]
    words = textwrap.wrap(f"{explain['text']} {explain['advice']}", int(14 * (len(panels) * (LEFT + wide) + GAP)))
    below = (max(len(s) for s in sentences) + len(words) + 1.5) * LINE
    width = MARGIN + len(panels) * (LEFT + wide + GAP)
    height = TOP + rows + below + MARGIN
    figure = new_figure(width, height)
    for k, demands in enumerate(panels):
        x = MARGIN / 2 + LEFT + k * (LEFT + wide + GAP)
        box = (x / width, (height - TOP - rows) / height, pattern["columns"] * BOX / width, rows / height)
        axes = figure.add_axes(box)
        _draw(axes, pattern, demands, explain["limbs"])
        axes.set_title(f"{demands[0]['family']}: {demands[0]['title']}", loc="left", fontsize=8, color=INK, pad=6)
        y = height - TOP - rows - 1.4 * LINE
        figure.text(x / width, y / height, "\n".join(sentences[k]), fontsize=7, color=INK, va="top", linespacing=1.25)
    figure.text(MARGIN / width, MARGIN / 2 / height, "\n".join(words), fontsize=8, color=INK, va="bottom")
    return png(figure)


def _by_family(demands: Sequence[Mapping[str, Any]]) -> list[list[Mapping[str, Any]]]:
    families: dict[str, list[Mapping[str, Any]]] = {}
    for demand in demands:
        families.setdefault(demand["family"], []).append(demand)
    return list(families.values())


def _sentences(demands: Sequence[Mapping[str, Any]], wide: float, most: int = 6) -> list[str]:
    """What the family says, wrapped to the width of its panel [in]."""
    lines: list[str] = []
    for demand in demands[:most]:
        lines += textwrap.wrap(f"{' '.join(demand['limbs'])}: {demand['text']}", int(wide * 15))
    return lines + ([f"and {len(demands) - most} more"] if len(demands) > most else [])


def _draw(
    axes: Axes, pattern: Mapping[str, Any], demands: Sequence[Mapping[str, Any]], concerned: Sequence[str]
) -> None:
    from matplotlib.patches import Rectangle

    limbs, columns = pattern["limbs"], pattern["columns"]
    walking = set(pattern["limbs_locomotive"])
    colors = {(i, j): STANCE if n in walking else BOUNDARY for i, n in enumerate(limbs) for j in range(columns)}
    for demand in demands:
        colors.update(_colors(demand, limbs))
    for (i, j), color in colors.items():
        axes.add_patch(Rectangle((j, i), 1, 1, facecolor=color, edgecolor=INK, linewidth=0.6))
    axes.set_xlim(0, columns)
    axes.set_ylim(len(limbs), 0)
    axes.set_yticks([i + 0.5 for i in range(len(limbs))], limbs, fontsize=7)
    for label, name in zip(axes.get_yticklabels(), limbs, strict=True):
        label.set_color(INK if name in walking else FAINT)
        label.set_fontweight("bold" if name in concerned else "normal")
    ticks = range(0, columns, 1 if columns <= 24 else 2)
    axes.set_xticks([j + 0.5 for j in ticks], [str(j + 1) for j in ticks], fontsize=6, color=FAINT)
    axes.tick_params(length=0, pad=2)


def _colors(demand: Mapping[str, Any], limbs: Sequence[str]) -> dict[tuple[int, int], str]:
    """Colours of the cells that a demand speaks of."""
    rows, columns, least = [limbs.index(n) for n in demand["limbs"]], demand["columns"], demand["at_least"]
    if demand["wants"] == "stance":
        color = SIMULATED if least >= len(rows) or len(columns) == 1 else SOME_STANCE
        return {(i, j): color for i in rows for j in columns}
    if demand["wants"] == "swing":
        return {(i, j): SWING if k < least else SOME_SWING for i in rows for k, j in enumerate(columns)}
    return {(i, j): ORDER for i in rows for j in columns}
