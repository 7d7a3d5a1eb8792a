"""The timeline column by column: one row per interval [t_j, t_j+1) of every repetition of every segment."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.timeline import Timeline


@dataclass(frozen=True, eq=False)
class Columns:
    """All K columns that are executed, in time order."""

    times: NDArray[np.float64]
    """(K + 1,) [s] where columns begin, and the end of the last"""
    contact: NDArray[np.bool_]
    """(K, n_F) planned contact"""
    segment: NDArray[np.intp]
    """(K,) index into `Timeline.entries`"""
    cycle: NDArray[np.intp]
    """(K,) which repetition of the segment"""
    column: NDArray[np.intp]
    """(K,) column of the segment's pattern"""

    def __len__(self) -> int:
        return len(self.segment)


def columns_of(timeline: Timeline) -> Columns:
    """The columns of a timeline; `Timeline.sample` reads C by the same boundaries."""
    times, contact, index = [], [], []
    for k, entry in enumerate(timeline.entries):
        m, duration = entry.plan.pattern.columns, entry.plan.duration
        for cycle in range(entry.cycles):
            times.append(entry.start + (cycle + np.arange(m) / m) * duration)
            contact.append(entry.plan.pattern.contact.T)
            index.append(np.stack([np.full(m, k), np.full(m, cycle), np.arange(m)], axis=1))
    segment, cycles, column = np.concatenate(index).astype(np.intp).T
    ends = np.array([timeline.duration])
    return Columns(np.concatenate([*times, ends]), np.concatenate(contact), segment, cycles, column)
