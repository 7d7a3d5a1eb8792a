"""Footfall patterns as in the paper's figure 2: a row a limb, a box a column, red boxes swing."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.timeline import Timeline
from gaitforge.record.archive import segment_names
from gaitforge.record.files import write_bytes, write_text
from gaitforge.report.figures import BOUNDARY, BOUNDARY_SWING, FAINT, INK, STANCE, SWING, new_figure, png

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True)
class Sizes:
    """Sizes of the picture; [in] unless said."""

    box: float = 0.2
    left: float = 0.4
    """room for limb names"""
    title: float = 0.4
    below: float = 0.32
    """room for column numbers"""
    margin: float = 0.15
    narrowest: int = 10
    """[columns] room that a segment takes at least, for its title"""
    widest: int = 60
    """[columns] that a line of segments may have"""


@dataclass(frozen=True)
class Slot:
    """Where a segment is drawn: its line, and its first column in the line."""

    name: str
    plan: MotionPlan
    line: int
    x: float
    """[in] of the boxes' left edge"""


def write_footfall_png(path: str | os.PathLike[str], timeline: Timeline) -> None:
    """Draw C of every segment, one below the other in the order of execution; one cycle of a gait.

    The first and last column of a transition are shaded: they belong to the gaits that it joins.
    InputError when the file cannot be written.
    """
    write_bytes(path, footfall_png(timeline))


def write_footfall_csv(path: str | os.PathLike[str], timeline: Timeline) -> None:
    """Write ``segment,limb,column,contact``, contact 1 = stance; columns are counted from 0."""
    lines = ["segment,limb,column,contact"]
    for name, plan in distinct_segments(timeline):
        for limb, row in zip(plan.pattern.limbs, plan.pattern.contact, strict=True):
            lines += [f"{_quoted(name)},{_quoted(limb)},{j},{int(c)}" for j, c in enumerate(row)]
    write_text(path, "\n".join(lines) + "\n")


def distinct_segments(timeline: Timeline) -> list[tuple[str, MotionPlan]]:
    """(name, plan) of every plan that is executed, each once."""
    names = segment_names(timeline)
    return list({name: (name, e.plan) for name, e in zip(names, timeline.entries, strict=True)}.values())


def footfall_png(timeline: Timeline, sizes: Sizes | None = None) -> bytes:
    """The picture as PNG: segments follow each other to the right, line after line."""
    size, segments = sizes or Sizes(), distinct_segments(timeline)
    slots = _slots(segments, size)
    boxes = max(len(plan.pattern.limbs) for _, plan in segments) * size.box
    line = size.title + boxes + size.below
    width = max(slot.x + _columns(slot.plan, size) * size.box for slot in slots) + size.margin
    height = (slots[-1].line + 1) * line + size.margin
    figure = new_figure(width, height)
    for slot in slots:
        rows, columns = slot.plan.pattern.contact.shape
        bottom = height - slot.line * line - size.title - rows * size.box
        box = (slot.x / width, bottom / height, columns * size.box / width, rows * size.box / height)
        _draw(figure.add_axes(box), slot.name, slot.plan)
    return png(figure)


def _slots(segments: list[tuple[str, MotionPlan]], size: Sizes) -> list[Slot]:
    slots: list[Slot] = []
    line, x, used = 0, size.left + size.margin, 0
    for name, plan in segments:
        if slots and used + _columns(plan, size) > size.widest:
            line, x, used = line + 1, size.left + size.margin, 0
        slots.append(Slot(name, plan, line, x))
        x += _columns(plan, size) * size.box + size.left + size.margin
        used += _columns(plan, size)
    return slots


def _columns(plan: MotionPlan, size: Sizes) -> int:
    return max(plan.pattern.columns, size.narrowest)


def _draw(axes: Axes, name: str, plan: MotionPlan) -> None:
    from matplotlib.patches import Rectangle

    contact = plan.pattern.contact
    limbs, columns = contact.shape
    for i in range(limbs):
        for j in range(columns):
            edge = plan.kind == "transition" and j in (0, columns - 1)
            colors = (BOUNDARY_SWING, BOUNDARY) if edge else (SWING, STANCE)
            axes.add_patch(Rectangle((j, i), 1, 1, facecolor=colors[int(contact[i, j])], edgecolor=INK, linewidth=0.7))
    axes.set_xlim(0, columns)
    axes.set_ylim(limbs, 0)
    axes.set_yticks([i + 0.5 for i in range(limbs)], plan.pattern.limbs, fontsize=7, color=INK)
    ticks = range(0, columns, 1 if columns <= 24 else 2)
    axes.set_xticks([j + 0.5 for j in ticks], [str(j + 1) for j in ticks], fontsize=6, color=FAINT)
    axes.tick_params(length=0, pad=2)
    for label, limb in zip(axes.get_yticklabels(), plan.pattern.limbs, strict=True):
        label.set_color(INK if limb in plan.pattern.locomotive else SWING)
    axes.set_title(_details(plan), loc="left", fontsize=6, color=FAINT, pad=3)
    axes.annotate(name, (0, 1), (0, 13), "axes fraction", "offset points", fontsize=8, color=INK, weight="bold")


def _details(plan: MotionPlan) -> str:
    pattern = plan.pattern
    walking = f"{len(pattern.locomotive)} of {len(pattern.limbs)} limbs"
    return f"{plan.kind} · {walking} · {pattern.columns} × {plan.duration / pattern.columns:.3g} s"


def _quoted(text: str) -> str:
    special = any(c in text for c in ',"\n')
    return '"' + text.replace('"', '""') + '"' if special else text
