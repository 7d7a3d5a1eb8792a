"""The general program: optima against brute force, known counts, and who can walk at all."""

from itertools import combinations, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_problems import (
    DODECAPOD,
    DODECAPOD_SIDES,
    HEXAPOD,
    all_patterns,
    gait,
    transition,
    without_gap,
)

from gaitforge.errors import InfeasibleFootfall, InputError, UnsolvedError
from gaitforge.footfall.constraints import (
    ChangeLimit,
    GapRule,
    LeftStance,
    RightStance,
    SharedStance,
    SharedSwing,
    StanceCount,
    StanceLength,
    StancePair,
    SwingDuty,
    SwingLength,
    default_constraints,
    with_problem_families,
)
from gaitforge.footfall.model import build_program, check_pattern
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.footfall.seam import canonical
from gaitforge.footfall.search import SearchOptions, solve, ties
from gaitforge.footfall.solvers.cpsat import CpSat

LIMBS, SIDES = ("L1", "L2", "R1"), ("left", "left", "right")


def least_changes(problem, families):
    """The smallest Σ y over all patterns, by looking at them; None when there is none."""
    per_limb = [f for f in families if f.scope == "limb"]
    others = [f for f in families if f.scope != "limb"]
    rows = []
    for i in range(len(problem.limbs)):
        allowed = []
        for row in all_patterns(1, problem.columns):
            whole = np.zeros((len(problem.limbs), problem.columns), dtype=bool)
            whole[i] = row[0]
            if not any(problem.limbs[i] in v.limbs for f in per_limb for v in f.violations(whole, problem)):
                allowed.append(row[0])
        rows.append(allowed)
    patterns = sorted(
        (FootfallPattern(np.array(rows), problem.limbs, problem.cyclic) for rows in product(*rows)),
        key=lambda p: p.changes,
    )
    return next((p.changes for p in patterns if not check_pattern(p.contact, problem, others)), None)


def cpsat_changes(problem, families, **settings):
    solution = CpSat(**settings).minimize(build_program(problem, families), 20.0, 0)
    if solution.status == "infeasible":
        return None
    assert solution.status == "optimal"
    assert solution.bound == solution.objective
    pattern = FootfallPattern(solution.contact, problem.limbs, problem.cyclic)
    assert pattern.changes == solution.objective, "Σ y is the number of changing boundaries"
    assert not check_pattern(solution.contact, problem, families)
    return solution.objective


families_drawn = st.builds(
    lambda *chosen: with_problem_families([c for c in chosen if c is not None]),
    st.sampled_from([ChangeLimit(), ChangeLimit(at_most=3), None]),
    st.sampled_from([SwingLength(), SwingLength(at_least=3), None]),
    st.sampled_from([StanceLength(), None]),
    st.sampled_from([StancePair(), None]),
    st.sampled_from([SwingDuty(), SwingDuty(at_least=1), None]),
    st.sampled_from([SharedStance(), SharedStance(at_most=0), None]),
    st.sampled_from([SharedSwing(), None]),
    st.sampled_from([StanceCount(at_least=1), StanceCount(at_least=2), StanceCount(all_but=1)]),
    st.sampled_from([LeftStance(), None]),
    st.sampled_from([RightStance(), None]),
    st.sampled_from([GapRule(), GapRule(up_to=0)]),
)
some_limbs = st.sets(st.sampled_from(LIMBS), min_size=1).map(lambda s: tuple(n for n in LIMBS if n in s))


@settings(max_examples=25, deadline=None, derandomize=True)
@given(families=families_drawn, walking=some_limbs, columns=st.integers(4, 6))
def test_the_optimum_of_a_small_gait_is_that_of_brute_force(families, walking, columns):
    problem = gait(walking, columns, LIMBS, SIDES)
    assert cpsat_changes(problem, families) == least_changes(problem, families)


@settings(max_examples=25, deadline=None, derandomize=True)
@given(
    families=families_drawn,
    before=some_limbs,
    after=some_limbs,
    first=st.integers(0, 7),
    last=st.integers(0, 7),
    columns=st.integers(4, 6),
)
def test_the_optimum_of_a_small_transition_is_that_of_brute_force(families, before, after, first, last, columns):
    ends = f"{first:03b}", f"{last:03b}"
    problem = transition(*ends, columns, before, after, LIMBS, SIDES)
    assert cpsat_changes(problem, families) == least_changes(problem, families)


def test_the_lean_settings_and_the_default_ones_agree():
    problem = gait(HEXAPOD[1:], 9)
    assert cpsat_changes(problem, without_gap()) == cpsat_changes(problem, without_gap(), lean=False) == 3


@pytest.mark.parametrize(
    ("first", "last", "columns", "limbs", "sides", "changes"),
    [
        ("010101", "011011", 11, HEXAPOD, ("left",) * 3 + ("right",) * 3, 2),
        ("011111111110", "011011110111", 18, DODECAPOD, DODECAPOD_SIDES, 2),
    ],
)
def test_the_transitions_of_the_paper_have_their_known_optimum(first, last, columns, limbs, sides, changes):
    problem = transition(first, last, columns, limbs, limbs, limbs, sides)
    assert cpsat_changes(problem, without_gap()) == changes


def test_the_printed_g8_costs_the_dodecapod_two_more_changes():
    families = [StanceCount(all_but=3) if f.key == "g8" else f for f in without_gap()]
    args = DODECAPOD, DODECAPOD, DODECAPOD, DODECAPOD_SIDES
    assert cpsat_changes(transition("011111111110", "011011110111", 18, *args), families) == 4


@pytest.mark.parametrize(
    ("lost", "changes", "patterns", "gaits"),
    [((), 2, 324, 27), (("L1",), 3, 2016, 168), (("L1", "R1"), 4, 1368, 114)],
)
def test_the_ties_of_the_hexapod_are_as_many_as_counted_elsewhere(lost, changes, patterns, gaits):
    problem = gait([n for n in HEXAPOD if n not in lost])
    listing = CpSat().listing(
        build_program(problem, without_gap()), most_changes=changes, limit=5000, time_limit_s=60, seed=0
    )
    assert listing.complete
    assert len(listing.contacts) == patterns
    assert len({canonical(c) for c in listing.contacts}) == gaits


def test_ties_are_distinct_gaits_and_satisfy_every_family():
    problem, families = gait(HEXAPOD[1:]), without_gap()
    best = solve(problem, families, SearchOptions())
    found = ties(problem, families, best, SearchOptions())
    assert len({canonical(p.contact) for p in found}) == len(found) == 168
    assert all(p.changes == best.changes and not check_pattern(p.contact, problem, families) for p in found)


def test_more_ties_than_the_limit_are_cut_off_and_said_to_be():
    problem = gait(DODECAPOD, 12, DODECAPOD, DODECAPOD_SIDES)
    program = build_program(problem, without_gap())
    listing = CpSat().listing(program, most_changes=2, limit=40, time_limit_s=20, seed=0)
    assert not listing.complete
    assert 28 <= len(listing.contacts) <= 40
    assert not any(check_pattern(c, problem, without_gap()) for c in listing.contacts)


def test_of_41_ways_to_lose_up_to_three_hexapod_limbs_15_have_a_pattern_and_26_a_proof():
    solved, proofs = {}, {}
    for k in (1, 2, 3):
        for lost in combinations(HEXAPOD, k):
            problem = gait([n for n in HEXAPOD if n not in lost])
            try:
                solved[lost] = solve(problem, without_gap(), SearchOptions())
                assert not check_pattern(solved[lost].contact, problem, without_gap())
            except InfeasibleFootfall as error:
                proofs[lost] = tuple(error.explain["families"])
                program = build_program(problem, [f for f in without_gap() if f.name in {*proofs[lost], "roles"}])
                assert CpSat().is_feasible(program, 10.0, 0) is False, "the families named clash by themselves"
    assert [sum(len(lost) == k for lost in solved) for k in (1, 2, 3)] == [6, 9, 0]
    assert len(proofs) == 26
    for lost, families in proofs.items():
        sides = {name[0] for name in lost}
        if len(lost) == 2:
            assert families == {"L": ("g5", "g9"), "R": ("g5", "g10")}[sides.pop()]
            assert not sides, "one limb lost on each side can be borne"
        elif len(sides) == 1:
            assert families == (("g9",) if sides == {"L"} else ("g10",))
        else:
            assert families == ("g5", "g8")


@pytest.mark.parametrize("walking", [3, 2, 1, 0])
def test_fewer_than_four_walking_limbs_have_no_gait_and_never_will(walking):
    names = ("L1", "R1", "L2")[:walking]
    with pytest.raises(InfeasibleFootfall) as caught:
        solve(gait(names), with_problem_families(None), SearchOptions())
    assert caught.value.explain["families"] == (["g5", "g8"] if walking == 3 else ["g8"])
    assert caught.value.explain["proof"] == "counting"


def test_the_same_seed_gives_the_same_pattern():
    problem = gait(HEXAPOD[1:])
    first, second = (solve(problem, without_gap(), SearchOptions(seed=3)).contact for _ in range(2))
    assert first.tobytes() == second.tobytes()


def test_dropping_a_family_never_makes_the_optimum_worse():
    problem = gait(HEXAPOD[1:], 10)
    families = with_problem_families(None)
    whole = cpsat_changes(problem, families)
    for dropped in default_constraints():
        rest = [f for f in families if f != dropped]
        assert cpsat_changes(problem, rest) <= whole


def test_without_time_for_an_answer_the_search_is_unsolved_not_infeasible():
    problem = gait(DODECAPOD, 40, DODECAPOD, DODECAPOD_SIDES)
    families = with_problem_families([*default_constraints()[:-1], GapRule(12)])
    with pytest.raises(UnsolvedError) as caught:
        solve(problem, families, SearchOptions(CpSat(), time_limit_s=1e-3))
    assert caught.value.explain["columns"] == 40


def test_everything_wrong_with_a_problem_is_told_at_once():
    problem = transition("011", "11111", 1, ("L1", "tail"), ("R1",), LIMBS, ("left", "left", "up"))
    with pytest.raises(InputError) as caught:
        build_program(problem, ())
    assert {p.key for p in caught.value.problems} == {"columns", "sides", "locomotive_before", "last"}


@pytest.mark.parametrize("columns", [0, 1, -3, 10**6])
def test_an_impossible_number_of_columns_is_refused_before_anything_is_built(columns):
    with pytest.raises(InputError) as caught:
        solve(gait(HEXAPOD, columns), without_gap(), SearchOptions())
    assert [p.key for p in caught.value.problems] == ["columns"]


@settings(max_examples=60, deadline=None, derandomize=True)
@given(families=families_drawn, walking=some_limbs, columns=st.integers(4, 8), first=st.none() | st.integers(0, 7))
def test_the_program_for_minimising_only_has_the_same_optimum(families, walking, columns, first):
    if first is None:
        problem = gait(walking, columns, LIMBS, SIDES)
    else:
        problem = transition(f"{first:03b}", "111", columns, walking, walking, LIMBS, SIDES)
    small, exact = (build_program(problem, families, exact=exact) for exact in (False, True))
    assert len(small.rows) <= len(exact.rows)
    answers = [CpSat().minimize(program, 20.0, 0) for program in (small, exact)]
    assert len({(a.status, a.objective) for a in answers}) == 1
    if answers[0].contact is not None:
        assert FootfallPattern(answers[0].contact, LIMBS, problem.cyclic).changes == answers[0].objective


def test_a_gait_that_may_stand_still_is_found_to_need_no_changes():
    families = [f for f in without_gap() if f.key != "g5"]
    pattern = solve(gait(HEXAPOD), families, SearchOptions(CpSat()))
    assert (pattern.changes, pattern.info["objective"], pattern.info["bound"]) == (0, 0, 0)
