"""How the feet share the robot's weight along a timeline, by its plans' weights, with as few jumps as there can be."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.timeline import Timeline, TimelineSamples

Array = NDArray[np.float64]
TINY = 1e-9
"""Below any sum of weights; where no foot is on the ground there are none to share"""


def foot_shares(timeline: Timeline, rows: TimelineSamples) -> Array:
    """(n, n_F) share of the weight that each foot bears, by the weights of the plans' CoP; a row sums up to 1, or is
    0 where no foot stands.

    Linear within an interval.  Where feet only lift, the weights after it are reached before it, and where feet only
    land, those before it are left after it: load comes and goes while a foot stands.  Where some lift and others
    land, it changes at once.
    """
    begin, end = _joined(timeline)
    intervals = np.array([len(entry.plan.times) - 1 for entry in timeline.entries])
    cycles = np.array([entry.cycles for entry in timeline.entries])
    seconds = np.array([entry.plan.duration for entry in timeline.entries]) / intervals
    starts = np.array([entry.start for entry in timeline.entries])
    before = np.concatenate([[0], np.cumsum(intervals * cycles)])
    k = rows.segment
    place = np.clip((rows.times - starts[k]) / seconds[k], 0.0, (intervals * cycles)[k] - 1e-9)
    interval = place.astype(np.intp)
    share = (place - interval)[:, None]
    return np.asarray((1.0 - share) * begin[before[k] + interval] + share * end[before[k] + interval])


def _joined(timeline: Timeline) -> tuple[Array, Array]:
    """(K, n_F) at the start and (K, n_F) at the end of every interval of the timeline, cycle after cycle."""
    first, last = zip(*(_weights(entry.plan) for entry in timeline.entries), strict=True)
    cycles = [entry.cycles for entry in timeline.entries]
    begin, end = (np.concatenate([np.tile(w, (n, 1)) for w, n in zip(s, cycles, strict=True)]) for s in (first, last))
    for k in range(len(begin) - 1):
        old, new = end[k] > 0.0, begin[k + 1] > 0.0
        if not (new & ~old).any():
            end[k] = begin[k + 1]
        elif not (old & ~new).any():
            begin[k + 1] = end[k]
    return begin, end


def _weights(plan: MotionPlan) -> tuple[Array, Array]:
    """(N, n_F) weights at the start and (N, n_F) at the end of every interval; equal ones where a plan has none."""
    contact = plan.pattern.contact.T.repeat(plan.samples_per_column, axis=0).astype(float)
    found = []
    for weights in (plan.weights[:-1, 1], plan.weights[1:, 0]):
        held = np.maximum(weights, 0.0) * contact
        held = np.where(held.any(axis=1, keepdims=True), held, contact)
        found.append(held / np.maximum(held.sum(axis=1, keepdims=True), TINY))
    return found[0], found[1]
