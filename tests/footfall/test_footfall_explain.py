"""Infeasible problems: the clash named is real, small, and says what would help."""

import pytest
from small_problems import HEXAPOD, gait, transition, without_gap

from gaitforge.errors import InfeasibleFootfall
from gaitforge.footfall.constraints import ConstraintSet, GapRule, default_constraints, with_problem_families
from gaitforge.footfall.explain import explain_infeasible
from gaitforge.footfall.model import build_program
from gaitforge.footfall.search import SearchOptions, solve
from gaitforge.footfall.solvers.cpsat import CpSat

QUADRUPED, SIDES = ("L1", "L2", "R1", "R2"), ("left", "left", "right", "right")


def feasible(problem, families, names):
    chosen = [f for f in families if f.name in {*names, "roles"}]
    return CpSat().is_feasible(build_program(problem, chosen), 20.0, 0)


CASES = {
    "two left limbs lost": gait(("L3", "R1", "R2", "R3")),
    "three limbs lost": gait(("L3", "R2", "R3")),
    "the whole left side lost": gait(("R1", "R2", "R3")),
    "too few columns for a stance": gait(HEXAPOD, 4),
    "too few columns for a quadruped": transition("0111", "1111", 11, QUADRUPED, QUADRUPED, QUADRUPED, SIDES),
    "boundary columns on two feet": transition("100001", "111111", 11),
}


@pytest.mark.parametrize("name", CASES)
def test_the_families_named_clash_and_any_one_left_out_they_do_not(name):
    problem, families = CASES[name], with_problem_families(None)
    names = explain_infeasible(problem, families, CpSat()).families
    assert feasible(problem, families, names) is False
    for left_out in names:
        assert feasible(problem, families, [n for n in names if n != left_out]) is True


def test_two_lost_left_limbs_set_the_left_side_against_the_swing_duty():
    clash = explain_infeasible(CASES["two left limbs lost"], with_problem_families(None), CpSat())
    assert clash.families == ("g5", "g9")
    assert clash.limbs == ("L3",)
    assert "only L3 walks" in clash.text
    assert clash.advice == "Keep another left limb locomotive, or lower the swing duty (g5.at_least)."


def test_a_whole_side_lost_needs_that_side_alone_as_a_reason():
    clash = explain_infeasible(CASES["the whole left side lost"], with_problem_families(None), CpSat())
    assert clash.families == ("g9",)


def test_boundary_columns_that_break_a_family_are_named_with_the_column():
    clash = explain_infeasible(CASES["boundary columns on two feet"], with_problem_families(None), CpSat())
    assert clash.families == ("boundary", "g8")
    assert clash.columns == (0,)


def test_the_number_of_columns_that_would_do_is_told():
    problem, families = CASES["too few columns for a quadruped"], with_problem_families(None)
    clash = explain_infeasible(problem, families, CpSat())
    assert "gap" in clash.families
    assert clash.columns_needed == 12
    assert clash.advice.startswith("Use 12 columns, or ")
    longer = transition("0111", "1111", 12, QUADRUPED, QUADRUPED, QUADRUPED, SIDES)
    assert solve(longer, families, SearchOptions()).columns == 12


def test_counting_and_the_solver_agree_on_a_gait_with_too_few_columns():
    clash = explain_infeasible(gait(HEXAPOD, 3), without_gap(), CpSat())
    assert (clash.proof, clash.families, clash.columns_needed) == ("counting", ("g5", "g8"), 5)
    assert feasible(gait(HEXAPOD, 4), without_gap(), [f.name for f in without_gap()]) is False
    assert feasible(gait(HEXAPOD, 5), without_gap(), [f.name for f in without_gap()]) is True


def test_the_exception_carries_plain_data_for_the_summary():
    with pytest.raises(InfeasibleFootfall) as caught:
        solve(CASES["too few columns for a stance"], with_problem_families(None), SearchOptions())
    explain = caught.value.explain
    assert set(explain) == {
        "families",
        "limbs",
        "columns",
        "text",
        "advice",
        "proof",
        "columns_needed",
        "demands",
        "pattern",
    }
    assert explain["families"] == ["g3", "g4", "g5"]
    assert len(explain["limbs"]) == 1
    assert explain["text"] in str(caught.value)
    assert explain["columns_needed"] == 5


def test_a_gap_rule_that_takes_the_last_column_is_to_blame():
    wide = [GapRule(6) if c.key == "gap" else c for c in default_constraints()]
    problem = transition("010101", "101010", 4)
    clash = explain_infeasible(problem, with_problem_families(wide), CpSat())
    assert "gap" in clash.families
    assert clash.columns_needed == 5
    assert feasible(problem, without_gap(), [f.name for f in without_gap()]) is True


def test_a_problem_that_has_a_pattern_is_not_explained_away():
    with pytest.raises(ValueError, match="has a pattern"):
        explain_infeasible(gait(HEXAPOD), with_problem_families(None), CpSat())


def test_every_family_says_what_would_help():
    for family in with_problem_families(None):
        assert family.relief != ConstraintSet.relief
        assert family.title
        assert family.equation
