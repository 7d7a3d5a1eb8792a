"""Patterns that need no search, where a cyclic one begins, and how stable a pattern is."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given as over
from hypothesis import settings
from hypothesis import strategies as st
from small_problems import DODECAPOD, DODECAPOD_SIDES, HEXAPOD, HEXAPOD_SIDES, gait

from gaitforge.errors import InputError
from gaitforge.footfall.constraints import with_problem_families
from gaitforge.footfall.given import alternating, given, wave
from gaitforge.footfall.margin import OUTSIDE, stability, support_margins
from gaitforge.footfall.model import check_pattern
from gaitforge.footfall.placement import offset_at, stance_offsets, step_rate
from gaitforge.footfall.ranking import Travel, diverse, ranked
from gaitforge.footfall.seam import airborne, at_grounded_seam, canonical, distinct_gaits
from gaitforge.footfall.waves import best_wave, swing_columns_for


def rows(*texts, limbs=HEXAPOD, cyclic=True):
    return given(dict(zip(limbs, texts, strict=False)), cyclic)


def test_the_alternating_tripod_is_that_of_the_paper():
    pattern = alternating(HEXAPOD, HEXAPOD_SIDES, 12)
    assert pattern.changes == 2
    assert [pattern.row(n)[0] for n in HEXAPOD] == [False, True, False, True, False, True]
    assert (pattern.contact[:, :6] == ~pattern.contact[:, 6:]).all()
    assert not check_pattern(pattern.contact, gait(HEXAPOD), with_problem_families(None))


def test_alternating_twelve_limbs_satisfies_every_family():
    pattern = alternating(DODECAPOD, DODECAPOD_SIDES, 12)
    problem = gait(DODECAPOD, 12, DODECAPOD, DODECAPOD_SIDES)
    assert not check_pattern(pattern.contact, problem, with_problem_families(None))
    assert (pattern.contact.sum(axis=0) == 6).all()


def test_the_order_of_rows_does_not_change_who_alternates_with_whom():
    mixed = ("R1", "L1", "R2", "L2", "L3", "R3")
    sides = tuple("left" if n[0] == "L" else "right" for n in mixed)
    pattern, usual = alternating(mixed, sides, 10), alternating(HEXAPOD, HEXAPOD_SIDES, 10)
    assert all((pattern.row(n) == usual.row(n)).all() for n in HEXAPOD)


def test_a_wave_swings_one_limb_at_a_time_with_all_standing_between():
    pattern = wave(("R3", "L2", "R2", "L3"), HEXAPOD, swing_columns=3, stance_columns=2)
    assert pattern.columns == 4 * 5
    assert pattern.locomotive == ("L2", "L3", "R2", "R3")
    swinging = (~pattern.contact[[1, 2, 4, 5]]).sum(axis=0)
    assert swinging.tolist() == [1, 1, 1, 0, 0] * 4
    assert not pattern.row("R3")[:3].any()
    assert pattern.changes == 8


@pytest.mark.parametrize("order", [(), ("L1", "L1"), ("L1", "tail")])
def test_a_wave_over_limbs_that_make_no_sense_is_refused(order):
    with pytest.raises(InputError) as caught:
        wave(order, HEXAPOD)
    assert caught.value.problems[0].key == "order"


def test_a_hand_written_pattern_may_be_text_or_numbers_and_bad_rows_are_named_together():
    pattern = given({"L1": "1100", "R1": [0, 0, 1, 1]})
    assert pattern.contact.astype(int).tolist() == [[1, 1, 0, 0], [0, 0, 1, 1]]
    with pytest.raises(InputError) as caught:
        given({"L1": "1100", "R1": "11", "R2": "1x00"})
    assert [p.key for p in caught.value.problems] == ["given.R1", "given.R2"]
    with pytest.raises(InputError):
        given({})


def test_a_foot_is_in_the_air_at_a_seam_only_when_it_swings_on_both_sides_of_it():
    pattern = rows("000111", "111000", limbs=("L1", "R1"))
    assert airborne(pattern.contact).tolist() == [0, 1, 1, 0, 1, 1]


def test_a_gait_is_turned_to_begin_with_every_walking_foot_on_the_ground():
    pattern = rows("100111", "111100", "000000", limbs=("L1", "R1", "R2"))
    turned = at_grounded_seam(replace(pattern, contact=np.roll(pattern.contact, 4, axis=1)))
    assert airborne(turned.contact)[0] == 0
    assert canonical(turned.contact) == canonical(pattern.contact)
    assert at_grounded_seam(turned) is turned


def test_a_gait_with_always_a_foot_in_the_air_begins_where_the_fewest_are():
    contact = np.ones((6, 12), dtype=bool)
    for i in range(6):
        contact[i, np.arange(2 * i, 2 * i + 4) % 12] = False
    pattern = replace(alternating(HEXAPOD, HEXAPOD_SIDES, 12), contact=contact)
    turned = at_grounded_seam(pattern)
    assert airborne(turned.contact)[0] == airborne(contact).min() == 1


def test_a_transition_is_never_turned():
    pattern = rows("0011", "1100", limbs=("L1", "R1"), cyclic=False)
    assert at_grounded_seam(pattern) is pattern


@settings(max_examples=50, deadline=None, derandomize=True)
@over(bits=st.integers(0, 2**15 - 1), shift=st.integers(0, 4))
def test_rotations_of_a_gait_are_one_gait(bits, shift):
    contact = np.array([bool(bits >> k & 1) for k in range(15)]).reshape(3, 5)
    turned = np.roll(contact, shift, axis=1)
    assert canonical(turned) == canonical(contact)
    kept = distinct_gaits((contact, turned))
    assert len(kept) == 1
    assert kept[0] is contact


@settings(max_examples=60, deadline=None, derandomize=True)
@over(seed=st.integers(0, 10**6), feet=st.integers(3, 8))
def test_margins_are_distances_to_the_edge_of_the_convex_hull(seed, feet):
    from shapely.geometry import MultiPoint, Point

    rng = np.random.default_rng(seed)
    places, points = rng.uniform(-0.4, 0.4, (feet, 2)), rng.uniform(-0.4, 0.4, (12, 2))
    stance = np.ones(feet, dtype=bool)
    stance[3:] = rng.random(feet - 3) < 0.5
    margins = support_margins(places[None], stance[None], points)[0]
    hull = MultiPoint(places[stance]).convex_hull
    for point, margin in zip(points, margins, strict=True):
        distance = hull.exterior.distance(Point(point))
        if hull.contains(Point(point)):
            assert margin == pytest.approx(distance, abs=1e-9)
        else:
            assert -distance - 1e-9 <= margin <= 1e-9


def test_every_polygon_may_have_points_of_its_own():
    rng = np.random.default_rng(3)
    places, points = rng.uniform(-0.4, 0.4, (5, 6, 2)), rng.uniform(-0.2, 0.2, (5, 4, 2))
    stance = rng.random((5, 6)) < 0.7
    one_by_one = [support_margins(places[k : k + 1], stance[k : k + 1], points[k])[0] for k in range(5)]
    assert support_margins(places, stance, points) == pytest.approx(np.array(one_by_one))


def test_two_feet_or_fewer_support_nothing():
    places, point = np.array([[0.1, 0.0], [-0.1, 0.0], [0.0, 0.2]]), np.zeros((1, 2))
    two, one = np.array([True, True, False]), np.array([True, False, False])
    assert support_margins(places[None], two[None], point)[0, 0] == pytest.approx(0.0)
    assert support_margins(places[None], one[None], point)[0, 0] == OUTSIDE


def test_a_swap_over_a_shared_line_has_no_margin_at_the_switch_and_a_gap_restores_it():
    square = np.array([[0.2, 0.2], [-0.2, 0.2], [0.2, -0.2], [-0.2, -0.2]])
    swap = np.array([[c == "1" for c in row] for row in ("0011", "1111", "1111", "1100")])
    gap = np.array([[c == "1" for c in row] for row in ("0111", "1111", "1111", "1101")])

    def at_switch(contact):
        feet = np.broadcast_to(square[:, None, None, :], (4, 4, 2, 2))
        return stability(contact, feet, np.zeros(2), 0.1, cyclic=True).switch_margin

    assert at_switch(swap) == pytest.approx(0.0, abs=1e-9)
    assert at_switch(gap) > 0.02


def test_in_a_gait_the_mean_stance_position_of_a_foot_is_its_foothold():
    pattern = rows("110011", "001111", limbs=("L1", "R1"))
    offsets = stance_offsets(pattern)
    assert offsets[0, :, 0].tolist() == [0, -1, 0, 0, 2, 1]
    assert offsets[0, :, 1].tolist() == [-1, -2, 0, 0, 1, 0]
    for i in range(2):
        assert offsets[i][pattern.contact[i]].mean() == pytest.approx(0.0)


def test_in_a_transition_a_foot_counts_where_it_is_before_or_after_its_own_step():
    pattern = rows("11001", limbs=("L1",), cyclic=False)
    coming, leaving = np.array([0.5]), np.array([-2.0])
    offsets = stance_offsets(pattern, (coming, leaving))
    assert offsets[0, 0].tolist() == [0.5, -0.5]
    assert offsets[0, 1].tolist() == [-0.5, -1.5]
    assert offsets[0, 4].tolist() == [-1.0, -2.0]
    assert step_rate(pattern, offsets, (coming, leaving)) == pytest.approx((-1.0 + 1.5) / 2)


def test_offsets_at_a_seam_hang_together_with_those_of_the_columns_beside_it():
    pattern = rows("110011", "001111", limbs=("L1", "R1"))
    assert offset_at(pattern, 0).tolist() == [0.0, -2.0]
    assert offset_at(pattern, 2).tolist() == [-2.0, 2.0]
    assert offset_at(pattern, 3).tolist() == [0.0, 1.0]


@pytest.mark.parametrize(("swing", "rate"), [(6, 1.0), (4, 2.0), (2, 5.0)])
def test_the_shorter_the_swing_the_faster_the_step(swing, rate):
    pattern = rows("0" * swing + "1" * (12 - swing), limbs=("L1",))
    assert step_rate(pattern, stance_offsets(pattern)) == pytest.approx(rate)


def walker(names, columns=12):
    """A problem with footholds in two straight rows."""
    holds = np.array([[0.15 - 0.15 * (i % 3), 0.2 if i < 3 else -0.2] for i in range(6)])
    return replace(gait(names, columns), footholds=holds)


TRAVEL = Travel(np.array([0.01, 0.0]))


def test_of_all_four_limbed_waves_one_that_goes_from_rear_to_front_is_chosen():
    pattern = best_wave(walker(("L1", "L3", "R1", "R3")), TRAVEL, 2)
    order = [n for n in pattern.info["order"]]
    assert order[(order.index("R3") + 1) % 4] == "R1"
    assert order[(order.index("L3") + 1) % 4] == "L1"


@pytest.mark.parametrize(("columns", "limbs", "swing"), [(12, 4, 2), (16, 4, 3), (12, 6, 2), (20, 4, 4), (12, 0, 11)])
def test_a_wave_spends_all_columns_but_one_a_limb_on_swings(columns, limbs, swing):
    assert swing_columns_for(columns, limbs) == swing


def test_the_order_of_candidates_is_by_margin_and_does_not_depend_on_how_they_came():
    problem = walker(HEXAPOD)
    tripod = alternating(HEXAPOD, HEXAPOD_SIDES, 12)
    one_sided = rows("0" * 6 + "1" * 6, "1" * 12, "0" * 6 + "1" * 6, "1" * 6 + "0" * 6, "0" * 6 + "1" * 6, "1" * 12)
    first = ranked([one_sided, tripod], problem, TRAVEL)
    second = ranked([tripod, one_sided], problem, TRAVEL)
    assert [p.contact.tobytes() for p in first] == [p.contact.tobytes() for p in second]
    assert (first[0].contact == tripod.contact).all()
    assert first[0].info["margin_m"] > first[1].info["margin_m"]


def test_diverse_candidates_are_apart_and_fill_up_when_they_cannot_be():
    base = np.ones((3, 6), dtype=bool)
    near, far = base.copy(), base.copy()
    near[0, 0] = False
    far[:, :3] = False
    patterns = [
        replace(alternating(("L1", "L2", "R1"), ("left", "left", "right"), 6), contact=c) for c in (base, near, far)
    ]
    assert diverse(patterns, 2) == (patterns[0], patterns[2])
    assert diverse(patterns, 3) == tuple(patterns)
