"""Figures without global state, whose files are the same for the same data."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SWING, STANCE, BOUNDARY, BOUNDARY_SWING = "#cd2d28", "#ffffff", "#d9dde1", "#9e1f1b"
PLANNED, SIMULATED, INK, FAINT = "#7fc796", "#1f4e9c", "#30363c", "#9aa4ad"
SHADES = {"gait": "#e8f1ea", "transition": "#fdeedd", "stand": "#eceff2"}
"""Background of a segment by its kind."""


def new_figure(width: float, height: float) -> Figure:
    """An empty figure of that size [in], drawn by Agg and not known to pyplot."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def png(figure: Figure, dpi: int = 130) -> bytes:
    """The figure as PNG, without a time or a version in it."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=dpi, metadata={"Software": None})
    return buffer.getvalue()
