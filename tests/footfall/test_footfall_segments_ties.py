"""Ties counted and listed by change times: known numbers, the general model's lists, even samples."""

import pytest
from hypothesis import given, settings
from random_problems import problems
from small_problems import DODECAPOD, DODECAPOD_SIDES, HEXAPOD, gait, transition, without_gap

from gaitforge.footfall.constraints import with_problem_families
from gaitforge.footfall.model import build_program, check_pattern
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.footfall.seam import canonical
from gaitforge.footfall.search import SearchOptions, solve, ties
from gaitforge.footfall.segments.listing import gait_key, tied_patterns
from gaitforge.footfall.segments.reading import read
from gaitforge.footfall.solvers.cpsat import CpSat
from gaitforge.footfall.solvers.segments import Segments


def listed(problem, families, most, limit=5000, effort=1_000_000):
    return tied_patterns(read(problem, families), most, limit, 200_000, effort)


def listed_by_cpsat(problem, families, most):
    program = build_program(problem, families)
    found = CpSat().listing(program, most_changes=most, limit=20_000, time_limit_s=60, seed=0)
    assert found.complete
    return found.contacts


@pytest.mark.parametrize(
    ("lost", "least", "gaits"), [((), 2, 27), (("L1",), 3, 168), (("L1", "R1"), 4, 114)], ids=["0", "1", "2"]
)
def test_the_distinct_gaits_of_the_hexapod_are_as_many_as_counted_elsewhere(lost, least, gaits):
    problem = gait([n for n in HEXAPOD if n not in lost])
    found = listed(problem, without_gap(), least)
    assert found.complete
    assert len({canonical(c) for c in found.contacts}) == len(found.contacts) == gaits


def test_the_gaits_of_four_limbs_with_gaps_are_those_of_the_general_model():
    problem, families = gait(("L2", "L3", "R2", "R3")), with_problem_families(None)
    found = listed(problem, families, 8)
    assert found.complete
    assert {canonical(c) for c in found.contacts} == {canonical(c) for c in listed_by_cpsat(problem, families, 8)}
    assert len(found.contacts) == 6


@settings(max_examples=60, deadline=None, derandomize=True)
@given(case=problems(most_limbs=4, most_columns=7))
def test_the_list_is_complete_and_says_every_pattern_once(case):
    problem, families = case
    solution, reason = Segments().search(problem, families)
    if reason:
        return
    most = problem.columns if solution.objective is None else solution.objective + 1
    found = listed(problem, families, most)
    name = canonical if problem.cyclic else (lambda contact: contact.tobytes())
    names = [name(c) for c in found.contacts]
    assert len(set(names)) == len(names)
    if found.complete:
        assert set(names) == {name(c) for c in listed_by_cpsat(problem, families, most)}
    else:
        assert found.counted > 2500
    assert bool(names) == (solution.status == "optimal")


def test_a_gait_has_one_name_from_wherever_it_is_written():
    problem = gait(HEXAPOD[1:])
    contacts = listed(problem, without_gap(), 3, limit=20).contacts
    for contact in contacts:
        pattern = FootfallPattern(contact, HEXAPOD)
        assert {gait_key(pattern.rotated(j).contact) for j in range(12)} == {gait_key(contact)}
    assert len({gait_key(c) for c in contacts}) == len(contacts)


def test_of_too_many_an_even_sample_is_listed_and_the_list_is_said_to_be_partial():
    problem = gait(DODECAPOD, 20, DODECAPOD, DODECAPOD_SIDES)
    found = listed(problem, without_gap(), 2, limit=100)
    assert not found.complete
    assert 90 <= len(found.contacts) <= 100
    assert found.counted > 5658, "the number of distinct gaits; those of symmetric times are counted twice"
    lengths = {tuple(sorted(int((~row).sum()) for row in contact)) for contact in found.contacts}
    assert len(lengths) > 5, "not all neighbours of one another"
    assert not any(check_pattern(c, problem, without_gap()) for c in found.contacts)


def test_slack_on_the_changes_leaves_room_for_the_best_ones():
    problem = transition("011111111110", "011011110111", 18, DODECAPOD, DODECAPOD, DODECAPOD, DODECAPOD_SIDES)
    found = listed(problem, without_gap(), 3, limit=60)
    counts = [FootfallPattern(c, DODECAPOD, False).changes for c in found.contacts]
    assert counts.count(2) == 3, "all that there are"
    assert 50 <= counts.count(3) <= 57
    assert found.counted > 10_000


def test_without_the_effort_to_count_a_few_patterns_are_listed_all_the_same():
    problem, families = gait(HEXAPOD[1:]), without_gap()
    found = listed(problem, families, 3, effort=30)
    assert not found.complete
    assert found.contacts
    assert not any(check_pattern(c, problem, families) for c in found.contacts)


def test_the_search_lists_ties_by_change_times_with_the_best_among_them():
    problem, families = gait(("L2", "L3", "R2", "R3")), without_gap()
    best = solve(problem, families, SearchOptions())
    found = ties(problem, families, best, SearchOptions())
    assert len(found) == 114
    assert canonical(best.contact) in {canonical(p.contact) for p in found}
    assert all(p.info["ties"] == 114 and p.info["ties_complete"] for p in found)
