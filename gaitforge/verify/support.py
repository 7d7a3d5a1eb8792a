"""Static margin: how far the centre of mass is inside the polygon of the feet that bear load."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise, permutations
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
NO_SUPPORT = -1.0
"""Margin [m] of a robot with no foot on the ground: a finite number far below any real margin."""


def bridged(contact: NDArray[np.bool_], steps: int) -> NDArray[np.bool_]:
    """(n, n_F) contact with interruptions of at most `steps` rows closed."""
    held = contact.copy()
    for foot in range(contact.shape[1]):
        touched = np.flatnonzero(contact[:, foot])
        for a, b in pairwise(touched):
            if 1 < b - a <= steps + 1:
                held[a:b, foot] = True
    return held


def static_margin(com: Array, points: Array, contact: NDArray[np.bool_]) -> Array:
    """Signed distance of each centre of mass from the border of its support polygon [m], > 0 inside.

    com (n, 2), points (n, n_F, 2) [m], contact (n, n_F).  With one or two feet on the ground the
    polygon is a point or a line, and the margin is at most 0; with none it is NO_SUPPORT.

    A line through two feet carries an edge when no other foot lies on its right.  The centre of
    mass is inside when it is on the left of every edge; its distance is that to the nearest edge.
    """
    inside, area = np.ones(len(com), dtype=bool), np.zeros(len(com), dtype=bool)
    nearest = np.full(len(com), np.inf)
    for rows, start, unit, length, wide in _edges(points, contact):
        offset = com[rows] - start
        along = np.clip((offset * unit).sum(axis=1), 0.0, length)
        nearest[rows] = np.minimum(nearest[rows], np.linalg.norm(offset - along[:, None] * unit, axis=1))
        inside[rows] &= _cross(unit, offset) >= 0.0
        area[rows] |= wide
    to_points = np.where(contact, np.linalg.norm(points - com[:, None], axis=2), np.inf).min(axis=1)
    nearest = np.where(np.isinf(nearest), to_points, nearest)  # all contacts in one place: there is no edge
    margin = np.where(inside & area, nearest, -nearest)
    return np.where(contact.any(axis=1), margin, NO_SUPPORT)


def _edges(points: Array, contact: NDArray[np.bool_]) -> Iterator[tuple[NDArray[np.intp], Array, Array, Array, Any]]:
    """Per ordered pair of feet: the rows in which it is an edge, start, direction, length, is a foot off it."""
    feet = contact.shape[1]
    for i, j in permutations(range(feet), 2):
        rows = np.flatnonzero(contact[:, i] & contact[:, j])
        start, way = points[rows, i], points[rows, j] - points[rows, i]
        length = np.linalg.norm(way, axis=1)
        unit = way / np.maximum(length, 1e-12)[:, None]
        side = _cross(unit[:, None], points[rows] - start[:, None])  # (k, n_F) [m], > 0 on the left
        side = np.where(contact[rows], side, 0.0)
        edge = (side >= -1e-9).all(axis=1) & (length > 1e-9)
        if edge.any():
            yield rows[edge], start[edge], unit[edge], length[edge], (side[edge] > 1e-9).any(axis=1)


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
