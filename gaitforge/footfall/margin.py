"""Static margins: how far inside the support polygon the centre of mass can be kept."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

OUTSIDE = -1.0
"""[m] margin over fewer than two feet, which support nothing"""


@dataclass(frozen=True)
class Stability:
    """How stable a pattern is over its stance feet; positions as in `placement`."""

    margin: float
    """[m] worst margin when the body is shifted once, as well as it can be"""
    switch_margin: float
    """[m] worst margin when the body may be elsewhere at each switch, but inside both polygons there"""


def support_margins(feet: Array, stance: NDArray[np.bool_], points: Array) -> Array:
    """(k, p) signed distance of p points (p, 2) from the edge of each of k support polygons, positive inside [m].

    `feet` (k, n, 2) and `stance` (k, n); points (k, p, 2): each polygon has its own.  Outside, the distance is
    to the line of the edge missed most.
    """
    edge = feet[:, None, :, :] - feet[:, :, None, :]  # (k, i, j, 2) from foot i to foot j
    length = np.linalg.norm(edge, axis=-1)
    normal = np.stack([edge[..., 1], -edge[..., 0]], axis=-1) / np.where(length > 1e-9, length, 1.0)[..., None]
    offset = np.einsum("kijd,kid->kij", normal, feet)
    reach = np.einsum("kijd,kld->kijl", normal, feet)
    inside = (reach <= offset[..., None] + 1e-9) | ~stance[:, None, None, :]
    hull = inside.all(axis=-1) & stance[:, :, None] & stance[:, None, :] & (length > 1e-9)
    polygon, i, j = np.nonzero(hull)
    mine = normal[polygon, i, j]
    along = mine @ points.T if points.ndim == 2 else np.einsum("ed,epd->ep", mine, points[polygon])
    distance = offset[polygon, i, j][:, None] - along  # (edges, p)
    margins = np.full((len(feet), points.shape[-2]), OUTSIDE)
    if len(polygon):
        first = np.flatnonzero(np.diff(polygon, prepend=-1))
        margins[polygon[first]] = np.minimum.reduceat(distance, first, axis=0)
    return margins


def stability(
    contact: NDArray[np.bool_], feet: Array, center_of_mass: Array, sway: float, cyclic: bool, steps: int = 9
) -> Stability:
    """Margins of a pattern (n_F, m).

    `feet` (n_F, m, 2, 2): positions at the start and end of each column [m]; `center_of_mass` (2,) [m];
    `sway`: how far the body may be shifted from its nominal place, ahead and sideways [m].  The shift is
    looked for on a grid of `steps`² places.
    """
    n, m = contact.shape
    line = np.linspace(-sway, sway, steps)
    grid = center_of_mass + np.stack(np.meshgrid(line, line, indexing="ij"), axis=-1).reshape(-1, 2)
    places = feet.transpose(1, 2, 0, 3).reshape(2 * m, n, 2)
    margins = support_margins(places, np.repeat(contact.T, 2, axis=0), grid).reshape(m, 2, -1)
    worst = float(margins.min(axis=(0, 1)).max())
    before = margins[:, 1] if cyclic else margins[:-1, 1]
    after = np.roll(margins[:, 0], -1, axis=0) if cyclic else margins[1:, 0]
    at_switch = np.minimum(before, after).max(axis=1)
    inner = margins.min(axis=1).max(axis=1)
    return Stability(worst, float(min(at_switch.min(initial=np.inf), inner.min())))
