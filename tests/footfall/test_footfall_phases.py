"""When a transition leaves and enters, and how long it is."""

import pytest

from gaitforge.errors import InfeasibleFootfall, InputError
from gaitforge.footfall.constraints import default_constraints, with_problem_families
from gaitforge.footfall.from_robot import transition_problem
from gaitforge.footfall.given import stand_pattern
from gaitforge.footfall.model import build_program, check_pattern
from gaitforge.footfall.phases import FEWEST, optimum_of
from gaitforge.footfall.search import SearchOptions
from gaitforge.footfall.solvers.cpsat import CpSat
from gaitforge.footfall.synthesis import (
    synthesize_gait_pattern,
    synthesize_transition_pattern,
    transition_pattern_candidates,
)
from gaitforge.robot.load import load_robot

FAMILIES = with_problem_families(None)


@pytest.fixture(scope="module")
def hexapod():
    return load_robot("hexapod")


@pytest.fixture(scope="module")
def gaits(hexapod):
    return [synthesize_gait_pattern(hexapod, locomotive=hexapod.limb_names[k:]) for k in (0, 1)]


def seams(pattern):
    return pattern.info["from_column"], pattern.info["to_column"]


def test_the_papers_choice_is_the_last_column_of_one_gait_and_the_first_of_the_other(hexapod, gaits):
    six, five = gaits
    pattern = synthesize_transition_pattern(hexapod, six, five, phases="paper")
    assert seams(pattern) == (11, 0)
    assert (pattern.contact[:, 0] == six.contact[:, -1]).all()
    assert (pattern.contact[:, -1] == five.contact[:, 0]).all()


def test_the_best_pair_of_phases_needs_no_more_changes_than_any_other(hexapod, gaits):
    """Against every pair, each solved by the general model."""
    six, five = gaits
    best = synthesize_transition_pattern(hexapod, six, five, columns=8, phases="best")
    leave, enter = seams(best)
    assert (best.contact[:, 0] == six.contact[:, leave]).all()
    assert (best.contact[:, -1] == five.contact[:, enter]).all()
    problem = transition_problem(hexapod, six, five, 8, leave, enter)
    assert not check_pattern(best.contact, problem, FAMILIES)
    options, fewest = SearchOptions(CpSat()), {}
    for a in range(12):
        for b in range(12):
            ends = six.contact[:, a].tobytes() + five.contact[:, b].tobytes()
            if ends not in fewest:
                fewest[ends] = optimum_of(transition_problem(hexapod, six, five, 8, a, b), FAMILIES, options).objective
    reached = [k for k in fewest.values() if k is not None]
    assert fewest[best.contact[:, 0].tobytes() + best.contact[:, -1].tobytes()] <= min(reached) + 1
    usual = synthesize_transition_pattern(hexapod, six, five, columns=8)
    margins = [round(min(p.info["switch_margin_m"], 0.03) / 0.002) for p in (best, usual)]
    assert margins[0] >= margins[1], "no worse than the usual pair"


def test_a_column_that_is_given_is_kept_while_the_other_is_searched(hexapod, gaits):
    pattern = synthesize_transition_pattern(hexapod, *gaits, columns=8, phases="best", to_column=3)
    assert seams(pattern)[1] == 3


def test_a_stand_has_one_phase_only(hexapod, gaits):
    stand = stand_pattern(hexapod, 4)
    pattern = synthesize_transition_pattern(hexapod, stand, gaits[1], columns=9, phases="best")
    assert pattern.contact[:, 0].all()
    assert seams(pattern)[0] == 3


@pytest.mark.parametrize("phases", ["seam", "best"])
def test_the_shortest_transition_has_a_pattern_and_one_column_less_has_none(hexapod, gaits, phases):
    six, five = gaits
    pattern = synthesize_transition_pattern(hexapod, five, six, columns="shortest", phases=phases)
    assert pattern.columns >= FEWEST
    if pattern.columns == FEWEST:
        return
    pairs = [(0, 11)] if phases == "seam" else [(a, b) for a in range(12) for b in range(12)]
    for a, b in pairs:
        problem = transition_problem(hexapod, five, six, pattern.columns - 1, a, b)
        assert CpSat().is_feasible(build_program(problem, FAMILIES), 5.0, 0) is False


def test_limbs_that_walk_in_one_gait_in_both_and_in_neither(hexapod, gaits):
    without = synthesize_gait_pattern(hexapod, locomotive=("L1", "L2", "L3", "R1", "R3"))
    held = synthesize_gait_pattern(hexapod, locomotive=("L1", "L2", "L3", "R2", "R3"))
    for pattern in transition_pattern_candidates(hexapod, without, held, columns=12, limit=3):
        assert not pattern.row("R1")[-2:].any(), "walked before only"
        assert not pattern.row("R2")[:2].any(), "walks afterwards only"
        assert (~pattern.row("L1")).sum() >= 2, "walks in both, so it takes a step"
    again = synthesize_transition_pattern(hexapod, without, without, columns=12)
    assert not again.row("R2").any(), "walks in neither"


def test_more_slack_gives_no_smaller_margin(hexapod):
    four = synthesize_gait_pattern(hexapod, locomotive=("L2", "L3", "R2", "R3"))
    five = synthesize_gait_pattern(hexapod, locomotive=("L1", "L2", "L3", "R2", "R3"))
    best = [transition_pattern_candidates(hexapod, five, four, columns=11, limit=1, slack=s)[0] for s in (0, 2)]
    assert best[0].changes == best[0].info["objective"]
    assert best[1].changes <= best[0].changes + 2
    margins = [round(min(p.info["switch_margin_m"], 0.03) / 0.002) for p in best]
    assert margins[1] >= margins[0]


def test_the_gap_rule_is_a_family_of_a_transition(hexapod):
    four = synthesize_gait_pattern(hexapod, locomotive=("L2", "L3", "R2", "R3"))
    pattern = synthesize_transition_pattern(hexapod, four, four, columns="shortest")
    before, after = pattern.contact[:, :-1], pattern.contact[:, 1:]
    assert not ((before & ~after).any(axis=0) & (~before & after).any(axis=0)).any()
    without = [c for c in default_constraints() if c.key != "gap"]
    assert synthesize_transition_pattern(hexapod, four, four, columns="shortest", constraints=without).columns < (
        pattern.columns
    )


def test_no_pair_of_phases_is_infeasible_with_its_reason(hexapod, gaits):
    with pytest.raises(InfeasibleFootfall) as caught:
        synthesize_transition_pattern(hexapod, *gaits, columns=2, phases="best")
    assert caught.value.explain["families"]


def test_unknown_phases_are_refused(hexapod, gaits):
    with pytest.raises(InputError) as caught:
        synthesize_transition_pattern(hexapod, *gaits, phases="full moon")
    assert caught.value.problems[0].key == "phases"
