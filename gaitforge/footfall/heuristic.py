"""The paper's static-stability heuristic: how far the centre of mass is from the middle of the feet that stand."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def centroid_heuristic(contact: NDArray[np.bool_], stance: Array, center_of_mass: Array) -> float:
    """Σ over the columns of the distance from the centre of mass to the centroid of the support polygon [m].

    `contact` (n_F, m); `stance` (n_F, 2) mean stance position of each foot in the original gait, `center_of_mass`
    (2,) [m].  Infinite when some column has nobody in stance.  Source: section III-B.1.
    """
    feet, middle = np.asarray(stance, dtype=float), np.asarray(center_of_mass, dtype=float).tobytes()
    return sum(_distance(feet[column].tobytes(), middle) for column in contact.T)


@lru_cache(maxsize=4096)
def _distance(points: bytes, center_of_mass: bytes) -> float:
    """Remembered: of patterns that are ranked together nearly all columns are alike."""
    centroid = support_centroid(np.frombuffer(points).reshape(-1, 2))
    return float(np.linalg.norm(centroid - np.frombuffer(center_of_mass)))


def support_centroid(points: Array) -> Array:
    """(2,) centroid of the area of the convex hull of points (k, 2); of a line its middle, of nothing infinity."""
    if len(points) == 0:
        return np.full(2, np.inf)
    hull = _hull(points)
    here, there = hull, np.roll(hull, -1, axis=0)
    origin = hull[0]
    cross = _cross(here - origin, there - origin)
    area = cross.sum()  # twice the area
    if area <= 1e-12:
        return np.asarray((points.min(axis=0) + points.max(axis=0)) / 2)
    third = (here + there - 2 * origin) / 3
    return np.asarray(origin + (third * cross[:, None]).sum(axis=0) / area)


def _hull(points: Array) -> Array:
    """Corners of the convex hull, counter-clockwise (monotone chain)."""
    ordered = np.unique(points, axis=0)
    if len(ordered) < 3:
        return ordered
    return np.array(_chain(ordered)[:-1] + _chain(ordered[::-1])[:-1])


def _chain(points: Array) -> list[Array]:
    chain: list[Array] = []
    for point in points:
        while len(chain) > 1 and _cross(chain[-1] - chain[-2], point - chain[-2]) <= 0:
            chain.pop()
        chain.append(point)
    return chain


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
