"""Feet put down elsewhere one by one, in the order with the best margins."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest
from shapely.geometry import MultiPoint, Point

from gaitforge.footfall.settling import LIFT, settling_patterns

LIMBS = ("L1", "L2", "L3", "R1", "R2", "R3")
FEET = np.array([[0.12, 0.2], [0.0, 0.22], [-0.12, 0.2], [0.12, -0.2], [0.0, -0.22], [-0.12, -0.2]])
STEP = np.array([[0.03, 0.0], [0.05, 0.02], [-0.04, 0.0], [0.0, 0.03], [0.05, -0.02], [-0.03, 0.01]])
CENTER = (np.array([0.01, 0.005]), np.array([0.01, 0.005]))


def margin_by_hand(order: tuple[str, ...], held: tuple[str, ...]) -> float:
    """The worst distance of the centre of mass from the edge of shapely's hull of the feet that stand [m]."""
    feet, worst = FEET.copy(), np.inf
    for name in order:
        standing = [n for n in (*order, *held) if n != name]
        hull = MultiPoint([feet[LIMBS.index(n)] for n in standing]).convex_hull
        point = Point(CENTER[0])
        worst = min(worst, hull.exterior.distance(point) * (1 if hull.contains(point) else -1))
        feet[LIMBS.index(name)] += STEP[LIMBS.index(name)]
    return float(worst)


def test_the_best_order_over_held_feet_is_the_one_that_trying_all_of_them_finds() -> None:
    walking, held = ("L2", "L3", "R1", "R3"), ("L1",)
    patterns = settling_patterns(LIMBS, walking, held, (FEET, FEET + STEP), CENTER, limit=24)
    found = [p.info["margin_m"] for p in patterns]
    assert found == sorted(found, reverse=True)
    every = {order: margin_by_hand(order, held) for order in permutations(walking)}
    assert found[0] == pytest.approx(max(every.values()), abs=1e-9)
    for pattern in patterns:
        if pattern.info["margin_m"] > 0:  # outside, a polygon's distance means something else
            assert pattern.info["margin_m"] == pytest.approx(every[pattern.info["order"]], abs=1e-9)


def test_every_walking_limb_takes_one_step_alone_and_stands_at_both_ends() -> None:
    walking = ("L1", "L3", "R1", "R2", "R3")
    (pattern,) = settling_patterns(LIMBS, walking, (), (FEET, FEET + STEP), CENTER, limit=1)
    assert pattern.locomotive == walking
    assert not pattern.cyclic
    assert pattern.contact[[LIMBS.index(n) for n in walking]].sum(axis=0).min() == len(walking) - 1
    for name in walking:
        row = pattern.row(name)
        assert row[0]
        assert row[-1]
        assert np.abs(np.diff(row.astype(int))).sum() == 2, "one step"


def test_held_limbs_bear_load_until_all_have_stepped() -> None:
    (pattern,) = settling_patterns(LIMBS, ("L2", "L3", "R2", "R3"), ("L1",), (FEET, FEET + STEP), CENTER, limit=1)
    assert pattern.row("L1").tolist() == [True] * (pattern.columns - LIFT) + [False] * LIFT
    assert pattern.contact[[1, 2, 4, 5], -LIFT:].all()
    assert not pattern.row("R1").any()
