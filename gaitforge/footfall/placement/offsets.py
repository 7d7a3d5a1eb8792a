"""Where the stance feet of a pattern are in the body frame while the body moves on."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitforge.footfall.constraints.runs import Run, runs_of
from gaitforge.footfall.pattern import FootfallPattern

Array = NDArray[np.float64]


def stance_offsets(pattern: FootfallPattern, ends: tuple[Array, Array] | None = None) -> Array:
    """(n_F, m, 2) how far each foot is ahead of its foothold at the start and end of each column [columns of travel].

    In a gait a foot is as far ahead when it lands as it is behind when it lifts: its mean stance position
    is its foothold.  In a transition `ends` holds, per limb, the offset with which it comes from the gait
    before and the one with which it has to leave (each (n_F,)): a stance phase that reaches an end hangs
    on that end, so a foot counts with its position before or after its own step.
    Entries of swing columns are 0.
    """
    n, m = pattern.contact.shape
    offsets = np.zeros((n, m, 2))
    for i, row in enumerate(pattern.contact):
        for run in runs_of(row, pattern.cyclic):
            if run.stance:
                ahead = _landing_offset(run, m, None if ends is None else (ends[0][i], ends[1][i]))
                for k, j in enumerate(run.columns(m)):
                    offsets[i, j] = ahead - k, ahead - k - 1
    return offsets


def step_rate(pattern: FootfallPattern, offsets: Array, ends: tuple[Array, Array] | None = None) -> float:
    """Largest mean speed of a foot in swing, in the body frame and in units of the body's own speed.

    `offsets` and `ends` as in `stance_offsets`.  A swing cut off by an end of a transition starts or stops at
    the gait's own offset there; a limb that does not walk on that side has none, and is left out.
    """
    m, worst = pattern.columns, 0.0
    for i, row in enumerate(pattern.contact):
        for run in runs_of(row, pattern.cyclic):
            if run.stance or not row.any():
                continue
            first, after = run.start, run.start + run.length
            if run.whole:
                lift, land = offsets[i, first - 1, 1], offsets[i, after % m, 0]
            elif ends is not None:
                lift = offsets[i, first - 1, 1] if first > 0 else ends[0][i]
                land = offsets[i, after, 0] if after < m else ends[1][i]
            else:
                continue
            worst = max(worst, abs(float(land - lift)) / run.length)
    return worst


def _landing_offset(run: Run, m: int, ends: tuple[float, float] | None) -> float:
    """Offset at the first instant of a stance phase [columns of travel]."""
    if ends is None:
        return run.length / 2
    coming, leaving = run.start == 0, run.start + run.length == m
    if coming and leaving:
        return float(ends[0] + ends[1] + m) / 2
    if coming:
        return float(ends[0])
    return float(ends[1] + run.length) if leaving else run.length / 2


def offset_at(pattern: FootfallPattern, column: int) -> Array:
    """(n_F,) offsets of a gait's feet at t_column [columns of travel]; the foothold itself for a foot in the air."""
    offsets, m = stance_offsets(pattern), pattern.columns
    here, before = column % m, (column - 1) % m
    on = np.where(pattern.contact[:, here], offsets[:, here, 0], 0.0)
    return np.where(pattern.contact[:, here] | ~pattern.contact[:, before], on, offsets[:, before, 1])
