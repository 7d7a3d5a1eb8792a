"""Support sectors: exact against geometry, and g9 and g10 as their special case."""

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from shapely.geometry import MultiPoint, Point
from small_problems import HEXAPOD, all_patterns, gait, without_gap

from gaitforge.errors import InfeasibleFootfall, InputError
from gaitforge.footfall.constraints import LeftStance, RightStance, SupportSectors
from gaitforge.footfall.constraints.g11_support_sectors import column_margins, support_sectors
from gaitforge.footfall.model import build_program, check_pattern
from gaitforge.footfall.search import SearchOptions, solve
from gaitforge.footfall.solvers.cpsat import CpSat

ROWS = np.array([[x, y] for y in (0.2, -0.2) for x in (0.25, 0.0, -0.25)])
"""Footholds of a hexapod, L1…L3, R1…R3 [m]."""


def margin(feet, p):
    """Radius of the largest disc about p inside the hull of the feet, by shapely; negative outside."""
    hull = MultiPoint([tuple(f) for f in feet]).convex_hull if len(feet) else Point(math.inf, math.inf)
    point = Point(*p)
    if hull.geom_type != "Polygon" or not hull.covers(point):
        return -hull.distance(point) if len(feet) else -math.inf
    return hull.exterior.distance(point)


def with_feet(problem, feet, p=(0.0, 0.0)):
    return replace(problem, footholds=np.asarray(feet, dtype=float), center_of_mass=np.asarray(p, dtype=float))


def stands(sectors, stance):
    """Whether each sector has one of its limbs in stance."""
    return all(any(stance[i] for i in sector) for sector in sectors)


places = st.tuples(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5))


@settings(max_examples=400, deadline=None, derandomize=True)
@given(
    feet=st.lists(places, min_size=1, max_size=8),
    p=places,
    delta=st.floats(1e-3, 0.2),
    stance=st.lists(st.booleans(), min_size=8, max_size=8),
)
def test_the_clauses_hold_exactly_where_the_disc_is_inside_the_support_polygon(feet, p, delta, stance):
    stance = stance[: len(feet)]
    found = margin([f for f, s in zip(feet, stance, strict=True) if s], p)
    assume(abs(found - delta) > 1e-7)
    sectors = support_sectors(np.array(feet) - np.array(p), delta)
    assert stands(sectors, stance) == (found > delta)


@settings(max_examples=40, deadline=None, derandomize=True)
@given(feet=st.lists(places, min_size=6, max_size=6), p=places, delta=st.floats(1e-3, 0.2))
def test_clauses_are_minimal_few_and_agree_with_geometry_on_every_stance_set(feet, p, delta):
    sectors = support_sectors(np.array(feet) - np.array(p), delta)
    assert len(sectors) <= 2 * len(feet)
    assert not [(a, b) for a in sectors for b in sectors if a != b and set(a) <= set(b)]
    for stance in product((False, True), repeat=6):
        found = margin([f for f, s in zip(feet, stance, strict=True) if s], p)
        if abs(found - delta) > 1e-7:
            assert stands(sectors, stance) == (found > delta)


@settings(max_examples=200, deadline=None, derandomize=True)
@given(feet=st.lists(places, min_size=3, max_size=7), p=places)
def test_the_check_measures_the_margin_that_shapely_measures(feet, p):
    found, expected = (
        column_margins(np.ones((len(feet), 1), dtype=bool), np.array(feet), np.array(p))[0],
        margin(feet, p),
    )
    if expected > 1e-6:
        assert found == pytest.approx(expected, abs=1e-7)
    elif expected < -1e-6:
        assert found <= 1e-7


@pytest.mark.parametrize("offset", [(0.0, 0.0), (0.03, 0.02)])
def test_symmetric_feet_whose_angles_coincide_give_clauses_that_agree_with_geometry(offset):
    sectors = support_sectors(ROWS - np.array(offset), 0.02)
    for stance in product((False, True), repeat=6):
        inside = margin([f for f, s in zip(ROWS, stance, strict=True) if s], offset) > 0.02
        assert stands(sectors, stance) == inside


def test_for_a_centre_on_the_midline_and_a_small_margin_the_sideways_clauses_are_those_of_g9_and_g10():
    problem = with_feet(gait(HEXAPOD), ROWS)
    clauses = {rule.limbs for rule in SupportSectors(delta=1e-3).rules(problem)}
    sides = [family.rules(problem)[0] for family in (LeftStance(), RightStance())]
    for side, normal in zip(sides, ((0, 1), (0, -1)), strict=True):
        assert side.at_least == 1
        assert side.limbs == tuple(np.flatnonzero(ROWS @ normal >= 1e-3))
        assert any(set(clause) <= set(side.limbs) for clause in clauses), "g11 implies it"
    for column in all_patterns(6, 1):
        if not SupportSectors(delta=1e-3).violations(column, replace(problem, columns=1)):
            assert not LeftStance().violations(column, replace(problem, columns=1))
            assert not RightStance().violations(column, replace(problem, columns=1))


@pytest.mark.parametrize("kind", ["triangle", "line", "far"])
def test_rows_are_feasible_exactly_where_the_check_finds_nothing(kind):
    feet = {
        "triangle": [[0.3, 0.0], [-0.2, 0.25], [-0.2, -0.25], [-0.4, 0.0]],
        "line": [[0.3, 0.0], [0.1, 0.0], [-0.2, 0.0], [-0.4, 0.0]],
        "far": [[0.3, 0.1], [0.1, 0.2], [0.2, 0.3], [0.4, 0.4]],
    }[kind]
    names = ("L1", "L2", "R1", "R2")
    problem = with_feet(gait(names, 2, names, ("left",) * 2 + ("right",) * 2), feet)
    family = SupportSectors(delta=0.01)
    listing = CpSat().listing(build_program(problem, [family]), most_changes=2, limit=10**4, time_limit_s=60, seed=0)
    assert listing.complete
    unbroken = {c.tobytes() for c in all_patterns(4, 2) if not family.violations(c, problem)}
    assert {c.tobytes() for c in listing.contacts} == unbroken
    assert bool(unbroken) == (kind == "triangle")


def test_limbs_that_do_not_walk_support_nothing():
    problem = with_feet(gait(HEXAPOD[1:], 1), ROWS, (0.2, 0.0))
    everyone = np.ones((6, 1), dtype=bool)
    assert SupportSectors().violations(everyone, problem)
    assert not SupportSectors().violations(everyone, with_feet(gait(HEXAPOD, 1), ROWS, (0.2, 0.0)))
    assert not any(0 in rule.limbs for rule in SupportSectors().rules(problem))


def test_a_lost_corner_limb_over_fixed_feet_clashes_and_is_explained_by_g11():
    problem = with_feet(gait(HEXAPOD[1:]), ROWS)
    families = (*without_gap(), SupportSectors(delta=0.02))
    with pytest.raises(InfeasibleFootfall) as caught:
        solve(problem, families, SearchOptions())
    assert "g11" in caught.value.explain["families"]


def test_a_pattern_found_with_g11_keeps_its_margin():
    problem = with_feet(gait(HEXAPOD), ROWS)
    families = (*without_gap(), SupportSectors(delta=0.05))
    pattern = solve(problem, families, SearchOptions())
    assert not check_pattern(pattern.contact, problem, families)
    for column in pattern.contact.T:
        assert margin(ROWS[column], (0, 0)) >= 0.05


@pytest.mark.parametrize(
    ("parameters", "keys"),
    [
        ({"delta": 0.0}, ["g11.delta"]),
        ({"delta": True}, ["g11.delta"]),
        ({"delta": math.inf}, ["g11.delta"]),
        ({"fallback": (-0.1,)}, ["g11.fallback"]),
        ({"delta": "wide", "fallback": (0.01, 0.0)}, ["g11.delta", "g11.fallback"]),
    ],
)
def test_margins_that_make_no_sense_are_refused_by_name(parameters, keys):
    with pytest.raises(InputError) as caught:
        SupportSectors(**parameters)
    assert [p.key for p in caught.value.problems] == keys


def test_margins_to_fall_back_on_are_those_below_the_one_asked_for_largest_first():
    assert SupportSectors(0.02, (0.004, 0.02, 0.01, 0.03)).margins == (0.02, 0.01, 0.004)


@pytest.mark.parametrize("feet", [None, np.zeros((5, 2)), np.full((6, 2), np.nan)])
def test_a_problem_without_footholds_cannot_have_g11(feet):
    with pytest.raises(InputError, match="footholds"):
        SupportSectors().rules(replace(gait(HEXAPOD), footholds=feet))
