"""One limb lost: the candidates of section III-B.1, figure 3, and the two rankings."""

from dataclasses import replace
from itertools import combinations, permutations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import MultiPoint

from benchmarks.figure3 import details, figure3, main
from gaitforge.errors import InputError
from gaitforge.footfall.candidates import candidates_without, merged, separated, switched
from gaitforge.footfall.constraints import with_problem_families
from gaitforge.footfall.from_robot import gait_problem
from gaitforge.footfall.gaps import gapped_first, needs_gaps
from gaitforge.footfall.given import alternating
from gaitforge.footfall.heuristic import centroid_heuristic, support_centroid
from gaitforge.footfall.lost_limb import lost_limb, lost_limb_gaits
from gaitforge.footfall.model import check_pattern
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.footfall.ranking import Travel, ranked
from gaitforge.footfall.synthesis import gait_pattern_candidates, synthesize_gait_pattern
from gaitforge.robot.load import load_robot
from tests.footfall.small_problems import DODECAPOD, DODECAPOD_SIDES, HEXAPOD, HEXAPOD_SIDES

FAMILIES = with_problem_families(None)
TRIPOD = alternating(HEXAPOD, HEXAPOD_SIDES, 12)


@pytest.fixture(scope="module")
def hexapod():
    return load_robot("hexapod")


def rows(pattern):
    return ["".join(str(int(c)) for c in row) for row in pattern.contact]


def turns(pattern):
    """Every rotation of a pattern, written out."""
    return {tuple(rows(pattern.rotated(k))) for k in range(pattern.columns)}


def swings(pattern, limb):
    return set(np.flatnonzero(~pattern.row(limb)).tolist())


def test_figure_three_holds_the_papers_patterns():
    a, b, c, d = figure3().values()
    assert rows(a) == ["000000111111", "111111000000"] * 3
    assert rows(b) == ["000000000000", *rows(a)[1:]]
    assert rows(c) == [rows(b)[i] for i in (0, 1, 2, 4, 3, 5)]
    assert {len(swings(d, n)) for n in ("L2", "L3", "R1", "R2", "R3")} == {4}
    assert swings(d, "L3") == swings(d, "R2")
    assert swings(d, "L2") == swings(d, "R3")
    assert not swings(d, "R1") & (swings(d, "L2") | swings(d, "L3"))


def test_the_figure_says_what_is_allowed_and_is_drawn_into_a_file(tmp_path):
    said = [details(pattern) for pattern in figure3().values()]
    assert [text.partition(" · ")[0] for text in said] == ["allowed", "breaks g8", "breaks g8", "allowed"]
    main([str(tmp_path / "new" / "figure3.png")])
    assert (tmp_path / "new" / "figure3.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("lost", HEXAPOD)
def test_the_candidates_are_all_switched_and_all_separated_patterns_each_once(lost):
    """Against a second way: sets of tuples, every rotation written out."""
    free = TRIPOD.contact.copy()
    free[HEXAPOD.index(lost)] = False
    base, walking = replace(TRIPOD, contact=free), [n for n in HEXAPOD if n != lost]
    groups = {n: swings(TRIPOD, n) for n in walking}
    expected = [base, *(switched(base, a, b) for a, b in combinations(walking, 2))]
    for a, b in permutations(walking, 2):
        if groups[a] == groups[b]:
            others = [n for n in walking if groups[n] == groups[a] and n != a]
            rest = [n for n in walking if groups[n] != groups[a]]
            for steps in (([a], others, rest), (others, [a], rest)):
                contact = np.ones((6, 12), dtype=bool)
                contact[HEXAPOD.index(lost)] = False
                for k, step in enumerate(steps):
                    contact[[HEXAPOD.index(n) for n in step], 4 * k : 4 * k + 4] = False
                expected.append(replace(base, contact=contact))
    found = candidates_without(TRIPOD, lost)
    assert {min(turns(p)) for p in found} == {min(turns(p)) for p in expected}
    assert len(found) == len({min(turns(p)) for p in expected})


def test_candidates_of_a_dodecapod_are_counted():
    """11 limbs in groups of 5 and 6: 1 + 30 switched; 11 limbs leave their group, before or after it."""
    whole = alternating(DODECAPOD, DODECAPOD_SIDES, 12)
    found = candidates_without(whole, "R2")
    by_operation = [sum(p.info["operation"] == o for p in found) for o in ("original", "switched", "separated")]
    assert by_operation == [1, 30, 22]


def test_separating_adds_as_many_columns_as_the_swing_has():
    (long,) = separated(TRIPOD, "R1", "R3")
    assert long.columns == 18
    assert swings(long, "R1") == set(range(12, 18)) or swings(long, "R1") == set(range(6))
    assert not swings(long, "R1") & swings(long, "R3")
    assert separated(TRIPOD, "R1", "L1") == (), "limbs that do not swing together have nothing to separate"


def test_a_swing_that_goes_on_across_the_new_step_is_not_cut():
    pattern = FootfallPattern.from_rows({"L1": "001111", "R1": "001111", "L2": "100001"})
    (long,) = separated(pattern, "R1", "L1")
    assert rows(long) == ["00111111", "11001111", "10000001"]


@given(st.lists(st.integers(1, 6), min_size=2, max_size=5), st.integers(2, 12))
@settings(max_examples=40, deadline=None, derandomize=True)
def test_merging_keeps_every_step_and_the_order_of_the_steps(lengths, columns):
    steps = np.eye(len(lengths), dtype=bool)
    pattern = FootfallPattern(np.repeat(~steps, lengths, axis=1), tuple(f"L{i + 1}" for i in range(len(lengths))))
    if columns < len(lengths):
        with pytest.raises(ValueError):
            merged(pattern, columns)
        return
    shorter = merged(pattern, columns)
    assert shorter.columns == columns
    order = np.argmin(shorter.contact, axis=0)
    assert (np.diff(order) >= 0).all()
    assert set(order) == set(range(len(lengths)))
    exact = np.array(lengths) * columns / sum(lengths)
    assert (np.abs((~shorter.contact).sum(axis=1) - exact) < 1 + (exact < 1).sum()).all()


def test_allowed_candidates_satisfy_every_family_in_the_fewest_columns(hexapod):
    problem = gait_problem(hexapod, HEXAPOD[1:], 8)
    original = alternating(HEXAPOD, HEXAPOD_SIDES, 8)

    def allowed(pattern):
        return not check_pattern(pattern.contact, replace(problem, columns=pattern.columns), FAMILIES)

    found = candidates_without(original, "L1", allowed)
    assert found
    assert all(allowed(p) and 8 <= p.columns <= 12 for p in found)
    for pattern in found:
        shorter = [merged(pattern, m) for m in range(8, pattern.columns)]
        assert not any(allowed(p) for p in shorter)


@given(st.lists(st.tuples(st.integers(-9, 9), st.integers(-9, 9)), min_size=3, max_size=8, unique=True))
@settings(max_examples=60, deadline=None, derandomize=True)
def test_the_centroid_of_a_support_polygon_is_that_of_its_area(points):
    hull = MultiPoint(points).convex_hull
    expected = np.array(hull.centroid.coords[0])
    assert support_centroid(np.array(points, dtype=float)) == pytest.approx(expected, abs=1e-9)


def test_the_heuristic_adds_up_the_columns():
    feet = np.array([[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]])
    contact = np.array([[1, 1, 0], [1, 0, 0], [1, 1, 1], [1, 1, 1]], dtype=bool)
    triangle, line = np.hypot(1 / 3, 1 / 3), 1.0
    assert centroid_heuristic(contact, feet, np.zeros(2)) == pytest.approx(0.0 + triangle + line)
    assert centroid_heuristic(np.zeros((4, 1), dtype=bool), feet, np.zeros(2)) == np.inf


def test_either_ranking_rules_and_both_stand_in_the_info(hexapod):
    problem = gait_problem(hexapod, HEXAPOD[1:], 12)
    found = candidates_without(TRIPOD, "L1")
    travel = Travel(np.array([0.01, 0.0]))
    by_centroid, by_margin = (ranked(found, problem, travel, by) for by in ("centroid", "margin"))
    centroids = [round(p.info["centroid_m"], 4) for p in by_centroid]
    assert centroids == sorted(centroids)
    margins = [round(min(p.info["margin_m"], 0.03) / 0.002) for p in by_margin]
    assert margins == sorted(margins, reverse=True)
    assert {p.info["ranked_by"] for p in by_centroid} == {"centroid"}
    assert all({"margin_m", "switch_margin_m", "centroid_m"} <= set(p.info) for p in by_margin)


def test_what_was_left_of_the_candidates_is_said_with_its_reason(hexapod):
    problem = gait_problem(hexapod, HEXAPOD[1:], 12)
    travel = Travel(np.array([hexapod.nominal.speed * hexapod.nominal.duration / 12, 0.0]))
    found, left = lost_limb_gaits(problem, FAMILIES, travel, *lost_limb(problem, None))
    assert found
    whys = dict(left)
    (what,) = [what for what, why in left if why == "breaks g8"]
    assert "the original without L1" in what
    assert "R1 and R2 switched" in what
    assert any("static margin" in why for why in whys.values()), "candidates that would tip are left as well"
    assert gait_pattern_candidates(hexapod, locomotive=HEXAPOD[1:])[0].info["left"] == left


def test_the_gait_before_is_what_a_lost_limb_is_taken_from(hexapod):
    wave = synthesize_gait_pattern(hexapod, method="wave", columns=12)
    found = gait_pattern_candidates(hexapod, locomotive=HEXAPOD[1:], columns=wave.columns, original=wave)
    (same,) = [p for p in found if p.info.get("operation") == "original"]
    free = wave.contact.copy()
    free[0] = False
    assert min(turns(same)) in turns(replace(wave, contact=free))


def test_two_limbs_lost_or_a_limb_that_begins_to_walk_are_other_reassignments(hexapod):
    assert lost_limb(gait_problem(hexapod, HEXAPOD[2:], 12), None) is None
    without = replace(TRIPOD, contact=TRIPOD.contact & (np.arange(6) != 5)[:, None])
    assert lost_limb(gait_problem(hexapod, HEXAPOD[1:], 12), without) is None
    assert lost_limb(gait_problem(hexapod, HEXAPOD[:4], 12), without)[1] == "R2"


def test_gapped_gaits_come_first_and_the_others_are_kept(hexapod):
    problem = gait_problem(hexapod, None, 12)
    gapped, plain = gapped_first([TRIPOD], problem, FAMILIES)
    assert needs_gaps(TRIPOD)
    assert plain is TRIPOD
    assert gapped.contact.all(axis=0).any()
    narrow = alternating(HEXAPOD, HEXAPOD_SIDES, 4)
    assert gapped_first([narrow], replace(problem, columns=4), FAMILIES) == [narrow], "no room for a gap"


def test_an_unknown_ranking_is_refused(hexapod):
    with pytest.raises(InputError) as caught:
        synthesize_gait_pattern(hexapod, ranking="beauty")
    assert caught.value.problems[0].key == "ranking"
