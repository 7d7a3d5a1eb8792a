"""Both faces of every family, over all patterns there are: rows against the check, and against the printed formulas."""

import numpy as np
import pytest
from small_problems import (
    FAMILIES,
    HEXAPOD,
    KINDS,
    LIMB_FAMILIES,
    OTHER_FAMILIES,
    all_patterns,
    gait,
    small,
    transition,
)

from gaitforge.errors import InputError
from gaitforge.footfall.constraints import (
    Boundary,
    ChangeLimit,
    GapRule,
    LeftStance,
    Roles,
    SharedStance,
    StanceCount,
    StanceLength,
    StancePair,
    SwingDuty,
    SwingLength,
    default_constraints,
)
from gaitforge.footfall.model import build_program
from gaitforge.footfall.solvers.cpsat import CpSat

CASES = [(family, size) for family in LIMB_FAMILIES for size in ((1, 8), (2, 5))]
CASES += [(family, size) for family in OTHER_FAMILIES for size in ((2, 6), (3, 4))]


def _feasible_in_cpsat(problem, family):
    listing = CpSat().listing(
        build_program(problem, [family]), most_changes=problem.columns, limit=10**6, time_limit_s=120, seed=0
    )
    assert listing.complete
    return {contact.tobytes() for contact in listing.contacts}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("family", "size"), CASES, ids=lambda value: str(value))
def test_rows_are_feasible_exactly_where_the_check_finds_nothing(family, size, kind):
    problem = small(*size, kind)
    unbroken = {c.tobytes() for c in all_patterns(*size) if not family.violations(c, problem)}
    assert _feasible_in_cpsat(problem, family) == unbroken


@pytest.mark.parametrize(
    ("kind", "silent"),
    [("gait", {Boundary(), GapRule(up_to=2)}), ("transition", {Roles(), GapRule(up_to=2)})],
)
def test_every_family_that_has_a_say_refuses_some_pattern_and_allows_another(kind, silent):
    undecided = set()
    for family in FAMILIES:
        problem = small(1, 8, kind) if family in LIMB_FAMILIES else small(3, 3, kind)
        verdicts = {not family.violations(c, problem) for c in all_patterns(len(problem.limbs), problem.columns)}
        if verdicts != {True, False}:
            assert verdicts == {True}
            undecided.add(family)
    assert undecided == silent


def _printed(c):
    """g1–g10 as the appendix prints them (g8 as its text says), literally, for a transition of n_F limbs."""
    n, m = c.shape
    c = c.astype(int)
    holds = {
        "g1": all(sum((c[i, j] - c[i, j + 1]) ** 2 for j in range(m - 1)) - 2 <= 0 for i in range(n)),
        "g2": all(c[i, j] - c[i, j + 1] + c[i, j + 2] - 1 <= 0 for i in range(n) for j in range(m - 2)),
        "g3": all(-c[i, j] + c[i, j + 1] - c[i, j + 2] <= 0 for i in range(n) for j in range(m - 2)),
        "g4": all(-c[i, j] + c[i, j + 1] + c[i, j + 2] - c[i, j + 3] - 1 <= 0 for i in range(n) for j in range(m - 3)),
        "g5": all(c[i].sum() - m + 2 <= 0 for i in range(n)),
        "g6": all(c[a].sum() - c[b].sum() - 2 <= 0 for a in range(n) for b in range(n) if a != b),
        "g7": all(-c[a].sum() + c[b].sum() - 2 <= 0 for a in range(n) for b in range(n) if a != b),
        "g8": all(-c[:, j].sum() + 3 <= 0 for j in range(m)),
        "g9": all(-c[: n // 2, j].sum() + 1 <= 0 for j in range(m)),
        "g10": all(-c[n // 2 :, j].sum() + 1 <= 0 for j in range(m)),
    }
    return {key for key, value in holds.items() if value}


@pytest.mark.parametrize("stance", [0.5, 0.8])
def test_the_checks_agree_with_the_formulas_of_the_appendix(stance):
    rng = np.random.default_rng(7)
    problem = transition("111111", "111111", 7)
    seen = set()
    for _ in range(300):
        contact = rng.random((6, 7)) < stance
        if rng.random() < 0.5:  # patterns with long phases, which random ones hardly have
            contact = np.sort(contact, axis=1)
        expected = _printed(contact)
        found = {f.key for f in default_constraints() if f.key != "gap" and not f.violations(contact, problem)}
        assert found == expected
        seen.add(frozenset(expected))
    assert len(seen) > 10


def test_rows_hold_for_a_tripod_written_by_hand_and_name_what_a_bad_one_breaks():
    problem = gait(HEXAPOD)
    tripod = np.array([[i % 2 == (j < 6) for j in range(12)] for i in range(6)])
    assert not [v for f in default_constraints() for v in f.violations(tripod, problem)]
    tripod[0, 8] = False
    broken = {v.family: v for f in default_constraints() for v in f.violations(tripod, problem)}
    assert set(broken) == {"g1", "g2", "g4", "g8"}
    assert broken["g2"].limbs == ("L1",)
    assert broken["g2"].columns == (8,)
    assert broken["g8"].columns == (8,)


def test_phases_wrap_in_a_gait_and_are_cut_off_in_a_transition():
    row = np.array([[False, True, True, True, True, False]])
    cyclic, cut = small(1, 6, "gait"), small(1, 6, "transition")
    assert not SwingLength(at_least=2).violations(row, cyclic)
    assert SwingLength(at_least=3).violations(row, cyclic)[0].columns == (5, 0)
    assert not SwingLength(at_least=3).violations(row, cut)


def test_the_printed_g8_allows_three_swinging_limbs_of_those_that_walk():
    problem = gait(HEXAPOD[1:])
    printed, text = StanceCount(all_but=3), StanceCount()
    two_stand = np.zeros((6, 12), dtype=bool)
    two_stand[1:3] = True
    assert not printed.violations(two_stand, problem)
    assert len(text.violations(two_stand, problem)) == 12


def test_sides_are_true_ones_whatever_the_order_of_the_rows():
    problem = gait(("a", "b", "c"), 4, ("a", "b", "c"), ("right", "left", "middle"))
    only_right = np.array([[True] * 4, [False] * 4, [True] * 4])
    found = LeftStance().violations(only_right, problem)
    assert [v.limbs for v in found] == [("b",)] * 4
    none_left = gait(("a", "c"), 4, ("a", "c"), ("right", "middle"))
    assert not LeftStance().violations(only_right[[0, 2]], none_left)


def test_the_gap_rule_is_in_force_for_few_limbs_only():
    swap = np.array([[i % 2 == (j < 6) for j in range(12)] for i in range(6)])
    assert not GapRule().violations(swap, gait(HEXAPOD))
    found = GapRule(up_to=6).violations(swap, gait(HEXAPOD))
    assert [v.columns for v in found] == [(5, 6), (11, 0)]
    assert not GapRule(up_to=0).violations(swap, gait(HEXAPOD[:4]))


def test_a_limb_that_changes_its_role_swings_where_it_does():
    joins = transition("011", "111", 6, ("L2", "R1"), ("L1", "L2", "R1"), ("L1", "L2", "R1"), ("left", "left", "right"))
    contact = np.ones((3, 6), dtype=bool)
    contact[0, :2] = False
    assert not Roles().violations(contact, joins)
    contact[0, 1] = True
    assert Roles().violations(contact, joins)[0].columns == (1,)


@pytest.mark.parametrize(
    ("family", "parameter", "value"),
    [
        (ChangeLimit, "at_most", -1),
        (SwingLength, "at_least", 0),
        (StanceLength, "at_least", 1.5),
        (StancePair, "at_least", 1),
        (SwingDuty, "at_least", -2),
        (SharedStance, "at_most", "two"),
        (StanceCount, "all_but", -1),
        (LeftStance, "at_least", True),
        (GapRule, "up_to", -1),
    ],
)
def test_a_parameter_that_makes_no_sense_is_refused_by_name(family, parameter, value):
    with pytest.raises(InputError) as caught:
        family(**{parameter: value})
    assert caught.value.problems[0].key == f"{family.key}.{parameter}"
    assert caught.value.problems[0].found == repr(value)
