"""Footholds for given stance sets: the worst margin made as large as the reach allows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitforge.footfall.margin import support_margins
from gaitforge.footfall.placement.reach import Reach

Array = NDArray[np.float64]

ROUNDS = 12
TRUST = 0.03
"""[m] first step length"""
SMALLEST = 1e-3
"""[m] step length below which the search ends"""
THRIFT = 1e-3
"""[-] of margin given up for a metre of displacement: feet that gain nothing stay where they are"""


@dataclass(frozen=True, eq=False)
class Cases:
    """Support polygons that have to hold the centre of mass, and at which place of the body each does."""

    stances: NDArray[np.bool_]
    """(K, n_F) the feet of each polygon"""
    places: NDArray[np.intp]
    """(K,) which of the body's places"""
    count: int
    """G, number of places; with one the body stays"""

    @staticmethod
    def still(contact: NDArray[np.bool_]) -> Cases:
        """One place for all columns of a pattern (n_F, m)."""
        stances = np.unique(contact.T, axis=0)
        return Cases(stances, np.zeros(len(stances), dtype=np.intp), 1)

    @staticmethod
    def swaying(contact: NDArray[np.bool_], times: Sequence[int], cyclic: bool) -> Cases:
        """One place for each of the `times` t_j, in the polygons of both columns that meet there.

        Between two of them the body moves on in a straight line inside one polygon, since that is convex.
        """
        m = contact.shape[1]
        columns = [{(j - 1) % m, j % m} if cyclic else {max(j - 1, 0), min(j, m - 1)} for j in times]
        pairs = [(contact[:, k], g) for g, beside in enumerate(columns) for k in sorted(beside)]
        return Cases(np.array([s for s, _ in pairs]), np.array([g for _, g in pairs], dtype=np.intp), len(times))


@dataclass(frozen=True, eq=False)
class Stance:
    """Offsets of the feet from their nominal footholds, and places of the body over them."""

    offsets: Array
    """(n_F, 2) [m] in the base frame of the first place"""
    shifts: Array
    """(G, 2) [m] from there; zero where the body stays"""


def worst_margin(stances: NDArray[np.bool_], feet: Array, center: Array) -> float:
    """[m] smallest margin over stance sets (k, n_F)."""
    places = np.broadcast_to(feet, (len(stances), *feet.shape))
    return float(support_margins(places, stances, np.asarray(center)[None]).min())


def margin_of(cases: Cases, feet: Array, centers: Array) -> float:
    """[m] worst margin with the centre of mass (G, 2) at each place."""
    return min(worst_margin(cases.stances[cases.places == g], feet, centers[g]) for g in range(cases.count))


def centers_of(reach: Reach, stance: Stance) -> Array:
    """(G, 2) the centre of mass at each place to first order [m]; legs that stay behind hold it back."""
    still = reach.center_of_mass + np.einsum("idk,ik->d", reach.gain, stance.offsets)
    return np.asarray(still + stance.shifts @ _follow(reach).T)


def _follow(reach: Reach) -> Array:
    """(2, 2) how far the centre of mass moves for a shift of the body over feet that stay."""
    return np.asarray(np.eye(2) - reach.gain[list(reach.walking)].sum(axis=0))


def spread(reach: Reach, cases: Cases, begin: Array, ample: float) -> tuple[Stance, float]:
    """Feet from the offsets `begin` (n_F, 2) on, places of the body, and the margin they give, up to `ample` [m].

    Sequential linear programs: the distance of the centre of mass from each edge is linear in small moves of
    the edge's two feet and of the centre; a step that does not help is halved.  A local optimum.
    """
    stance, trust = Stance(begin.copy(), np.zeros((cases.count, 2))), TRUST
    margin = margin_of(cases, reach.footholds + stance.offsets, centers_of(reach, stance))
    for _ in range(ROUNDS):
        if margin >= ample or trust < SMALLEST:
            break
        trial = _step(reach, cases, stance, trust, ample)
        if trial is not None:
            found = margin_of(cases, reach.footholds + trial.offsets, centers_of(reach, trial))
            if found > margin + 1e-5:
                stance, margin = trial, found
                continue
        trust /= 2
    return stance, margin


def _step(reach: Reach, cases: Cases, stance: Stance, trust: float, ample: float) -> Stance | None:
    """The stance after one linear program: moves of the feet (2w), of the body (2G), the feet's sizes (2w), t."""
    from scipy.optimize import linprog

    w, g = len(reach.walking), cases.count
    rows, bounds = _reach_rows(reach, stance)
    for more in (_margin_rows(reach, cases, stance), _apart_rows(reach, stance), _size_rows(reach, stance)):
        rows, bounds = rows + more[0], bounds + more[1]
    cost = np.concatenate([np.zeros(2 * w + 2 * g), np.full(2 * w, THRIFT), [-1.0]])
    sway = trust if g > 1 else 0.0
    limits = [(-trust, trust)] * (2 * w) + [(-sway, sway)] * (2 * g) + [(0.0, None)] * (2 * w) + [(None, ample)]
    result = linprog(cost, np.array(rows), np.array(bounds), bounds=limits)
    if not result.success:
        return None
    offsets = stance.offsets.copy()
    offsets[list(reach.walking)] += result.x[: 2 * w].reshape(w, 2)
    return Stance(offsets, stance.shifts + result.x[2 * w : 2 * w + 2 * g].reshape(g, 2))


Rows = tuple[list[Array], list[float]]


def _empty(reach: Reach, stance: Stance) -> Array:
    return np.zeros(4 * len(reach.walking) + 2 * len(stance.shifts) + 1)


def _reach_rows(reach: Reach, stance: Stance) -> Rows:
    """n · (offset − shift) ≤ extent for every foot and every place of the body."""
    rows, bounds, w = [], [], len(reach.walking)
    for k, i in enumerate(reach.walking):
        for g, shift in enumerate(stance.shifts):
            for normal, extent in zip(reach.normals[i], reach.extents[i], strict=True):
                row = _empty(reach, stance)
                row[2 * k : 2 * k + 2] = normal
                row[2 * w + 2 * g : 2 * w + 2 * g + 2] = -normal
                rows.append(row)
                bounds.append(max(0.0, float(extent - normal @ (stance.offsets[i] - shift))))
    return rows, bounds


def _apart_rows(reach: Reach, stance: Stance) -> Rows:
    rows, bounds, feet = [], [], reach.footholds + stance.offsets
    column = {i: 2 * k for k, i in enumerate(reach.walking)}
    for a, b, least in reach.neighbours:
        row = _empty(reach, stance)
        for i, sign in ((a, -1.0), (b, 1.0)):
            if i in column:
                row[column[i]] = sign
        rows.append(row)
        bounds.append(max(0.0, float(feet[a, 0] - feet[b, 0]) - least))
    return rows, bounds


def _size_rows(reach: Reach, stance: Stance) -> Rows:
    """|offset| ≤ size, coordinate by coordinate."""
    rows, bounds, w = [], [], len(reach.walking)
    now = stance.offsets[list(reach.walking)].ravel()
    for k in range(2 * w):
        for sign in (1.0, -1.0):
            row = _empty(reach, stance)
            row[k], row[2 * w + 2 * len(stance.shifts) + k] = sign, -1.0
            rows.append(row)
            bounds.append(-sign * float(now[k]))
    return rows, bounds


def _margin_rows(reach: Reach, cases: Cases, stance: Stance) -> Rows:
    """t − ∇d · move ≤ d for the distance d of the centre from each edge of each support polygon."""
    w, feet, centers = len(reach.walking), reach.footholds + stance.offsets, centers_of(reach, stance)
    column = {i: 2 * k for k, i in enumerate(reach.walking)}
    follow = _follow(reach)
    rows, bounds, seen = [], [], set()
    for members, place in zip(cases.stances, cases.places.tolist(), strict=True):
        for a, b in _hull(np.flatnonzero(members), feet):
            if (a, b, place) in seen:
                continue
            seen.add((a, b, place))
            edge = feet[b] - feet[a]
            length = float(np.linalg.norm(edge))
            inward = np.array([-edge[1], edge[0]]) / length
            along = float(edge @ (centers[place] - feet[a])) / length**2
            row = _empty(reach, stance)
            row[-1] = 1.0
            # near the foot of the perpendicular an edge moves as a mean of its ends, weighted by `along`
            for i, share in ((a, 1.0 - along), (b, along)):
                row[column[i] : column[i] + 2] += share * inward
            for i, k in column.items():
                row[k : k + 2] -= inward @ reach.gain[i]
            row[2 * w + 2 * place : 2 * w + 2 * place + 2] = -inward @ follow
            rows.append(row)
            bounds.append(float(inward @ (centers[place] - feet[a])))
    return rows, bounds


def _hull(members: NDArray[np.intp], feet: Array) -> list[tuple[int, int]]:
    """Edges (a, b) of the hull of some feet, counter-clockwise."""
    order = sorted(members.tolist(), key=lambda i: (feet[i, 0], feet[i, 1]))
    if len(order) < 3:
        return [(a, b) for a in order for b in order if a != b]
    chain: list[int] = []
    for half in (order, order[::-1]):
        part: list[int] = []
        for i in half:
            while len(part) > 1 and _turn(feet[part[-2]], feet[part[-1]], feet[i]) <= 0:
                part.pop()
            part.append(i)
        chain += part[:-1]
    return list(zip(chain, chain[1:] + chain[:1], strict=True))


def _turn(a: Array, b: Array, c: Array) -> float:
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
