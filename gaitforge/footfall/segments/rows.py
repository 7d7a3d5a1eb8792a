"""The rows that a type of limb may have, as tables over where a run begins and ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitforge.footfall.segments.reading import LimbType


@dataclass(frozen=True, eq=False)
class Rows:
    """Allowed rows: swing on [s, e) with stance elsewhere, stance on [s, e) with swing elsewhere, or neither."""

    swing: NDArray[np.bool_]
    """(m + 1, m + 1) entry (s, e); cyclic: arcs s → e ≠ s, columns modulo m"""
    stance: NDArray[np.bool_]
    """(m + 1, m + 1) entry (s, e), 0 < s < e < m; never in a gait, where `swing` says it"""
    always_stance: bool
    always_swing: bool

    @property
    def must_swing(self) -> bool:
        """Whether the limb cannot stand throughout."""
        return not self.always_stance


def rows_of_type(limb_type: LimbType, m: int, cyclic: bool) -> Rows:
    """The rows of m columns that satisfy every rule of the type."""
    return _cyclic(limb_type, m) if cyclic else _transition(limb_type, m)


def _constant(limb_type: LimbType, m: int) -> tuple[bool, bool]:
    stance = not limb_type.swing_in and limb_type.least_swing <= 0 and limb_type.least_stance <= m
    swing = not limb_type.stance_in and limb_type.least_stance <= 0 and limb_type.least_swing <= m
    return stance, swing


def _forbidden(runs: frozenset[int], m: int) -> NDArray[np.bool_]:
    """(m + 1,) by length"""
    table = np.zeros(m + 1, dtype=bool)
    table[[length for length in runs if length <= m]] = True
    return table


def _changes_allowed(limb_type: LimbType) -> int:
    return 2 if limb_type.most_changes is None else limb_type.most_changes


def _cyclic(limb_type: LimbType, m: int) -> Rows:
    always_stance, always_swing = _constant(limb_type, m)
    at = np.arange(m + 1)
    length = (at[None, :] - at[:, None]) % m  # (s, e)
    allowed = (length > 0) & (length >= limb_type.least_swing) & (m - length >= limb_type.least_stance)
    allowed &= ~_forbidden(limb_type.swing_runs, m)[length] & ~_forbidden(limb_type.stance_runs, m)[m - length]
    if _changes_allowed(limb_type) < 2 or limb_type.swing_in or limb_type.stance_in:
        allowed[:] = False
    return Rows(allowed, np.zeros_like(allowed), always_stance, always_swing)


def _transition(limb_type: LimbType, m: int) -> Rows:
    always_stance, always_swing = _constant(limb_type, m)
    at = np.arange(m + 1)
    s, e = at[:, None], at[None, :]
    length = e - s
    inner = (s > 0) & (e < m)
    changes = (s > 0).astype(int) + (e < m)
    least_swing, least_stance = limb_type.least_swing, limb_type.least_stance
    allowed = changes <= _changes_allowed(limb_type)
    size = np.clip(length, 0, m)
    swing = (length > 0) & allowed & (length >= least_swing) & (m - length >= least_stance)
    swing &= ~(inner & _forbidden(limb_type.swing_runs, m)[size])
    swing &= _covers(limb_type.swing_in, limb_type.stance_in, m)
    stance = (length > 0) & inner & allowed & (length >= least_stance) & (m - length >= least_swing)
    stance &= ~_forbidden(limb_type.stance_runs, m)[size]
    stance &= _covers(limb_type.stance_in, limb_type.swing_in, m)
    return Rows(swing, stance, always_stance, always_swing)


def _covers(inside: frozenset[int], outside: frozenset[int], m: int) -> NDArray[np.bool_] | bool:
    """(m + 1, m + 1) whether [s, e) has every column of `inside` and none of `outside`."""
    if not inside and not outside:
        return True
    at = np.arange(m + 1)
    s, e = at[:, None], at[None, :]
    fits: NDArray[np.bool_] = np.ones((m + 1, m + 1), dtype=bool)
    if inside:
        fits = (s <= min(inside)) & (e > max(inside))
    if outside:
        before = np.zeros(m + 1, dtype=int)
        before[[j + 1 for j in outside]] = 1
        before = before.cumsum()
        fits = fits & (before[None, :] == before[:, None])
    return fits
