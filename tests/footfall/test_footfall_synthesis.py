"""Patterns for real robots: every one returned satisfies every family, and hangs together at the seams."""

import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gaitforge.errors import InfeasibleFootfall, InputError
from gaitforge.footfall.constraints import (
    GapRule,
    GeneralConstraint,
    StanceCount,
    default_constraints,
    with_problem_families,
)
from gaitforge.footfall.from_robot import gait_problem, transition_problem
from gaitforge.footfall.given import stand_pattern
from gaitforge.footfall.model import check_pattern
from gaitforge.footfall.seam import airborne, canonical
from gaitforge.footfall.synthesis import (
    gait_pattern_candidates,
    synthesize_gait_pattern,
    synthesize_transition_pattern,
    transition_pattern_candidates,
)
from gaitforge.robot.load import load_robot

FAMILIES = with_problem_families(None)
FOUR = ("L2", "L3", "R2", "R3")


@pytest.fixture(scope="module")
def hexapod():
    return load_robot("hexapod")


@pytest.fixture(scope="module")
def dodecapod():
    return load_robot("dodecapod")


@pytest.fixture(scope="module")
def quadruped():
    return load_robot("quadruped")


def broken(robot, pattern, locomotive=None):
    return check_pattern(pattern.contact, gait_problem(robot, locomotive, pattern.columns), FAMILIES)


def test_a_hexapod_walks_on_the_alternating_tripod(hexapod):
    pattern = synthesize_gait_pattern(hexapod)
    assert pattern.contact[:, 0].tolist() == [False, True, False, True, False, True]
    assert pattern.changes == 2
    assert pattern.source == "candidate"


def test_a_quadruped_walks_on_a_wave_with_gaps(quadruped):
    pattern = synthesize_gait_pattern(quadruped, columns=12)
    assert not broken(quadruped, pattern)
    swinging = (~pattern.contact).sum(axis=0)
    assert swinging.max() == 1
    assert (swinging == 0).sum() == 4, "after each swing all four stand"


def test_the_original_tripod_with_one_limb_free_is_the_first_choice_of_a_dodecapod(dodecapod):
    rest = [n for n in dodecapod.limb_names if n != "R2"]
    pattern, whole = (synthesize_gait_pattern(dodecapod, locomotive=names) for names in (rest, None))
    assert not pattern.row("R2").any()
    assert all((pattern.row(n) == whole.row(n)).all() for n in rest)


def test_the_same_pattern_with_a_free_limb_is_left_out_where_it_leaves_two_feet(hexapod):
    for pattern in gait_pattern_candidates(hexapod, locomotive=hexapod.limb_names[1:]):
        assert pattern.contact.sum(axis=0).min() >= 3
        assert pattern.info.get("operation") != "original"


@settings(max_examples=12, deadline=None, derandomize=True)
@given(lost=st.sets(st.sampled_from(("L1", "L2", "L3", "R1", "R2", "R3")), max_size=2), columns=st.integers(10, 14))
def test_every_gait_returned_satisfies_every_family_and_begins_on_the_ground(lost, columns):
    robot = load_robot("hexapod")
    walking = [n for n in robot.limb_names if n not in lost]
    if len(lost) == 2 and len({n[0] for n in lost}) == 1:
        with pytest.raises(InfeasibleFootfall):
            gait_pattern_candidates(robot, locomotive=walking, columns=columns)
        return
    found = gait_pattern_candidates(robot, locomotive=walking, columns=columns)
    assert 1 <= len(found) <= 6
    assert len({(p.columns, canonical(p.contact)) for p in found}) == len(found)
    for pattern in found:
        assert not broken(robot, pattern, walking)
        assert pattern.cyclic
        assert pattern.limbs == robot.limb_names
        assert pattern.source == "wave" or pattern.columns == columns
        in_air = airborne(pattern.contact)
        assert in_air[0] == in_air.min()


@settings(max_examples=10, deadline=None, derandomize=True)
@given(
    pair=st.tuples(*[st.sampled_from(((), ("R1",), ("L2",), ("L1", "R1"), ("L2", "R3")))] * 2),
    columns=st.integers(9, 14),
)
def test_every_transition_returned_satisfies_every_family_between_its_columns(pair, columns):
    robot = load_robot("hexapod")
    before, after = (
        synthesize_gait_pattern(robot, locomotive=[n for n in robot.limb_names if n not in lost]) for lost in pair
    )
    problem = transition_problem(robot, before, after, columns)
    if len(problem.locomotive_anywhere) == 4 and columns < 12:
        with pytest.raises(InfeasibleFootfall) as caught:
            transition_pattern_candidates(robot, before, after, columns=columns, limit=4)
        assert caught.value.explain["columns_needed"] == 12
        return
    found = transition_pattern_candidates(robot, before, after, columns=columns, limit=4)
    for pattern in found:
        assert not check_pattern(pattern.contact, problem, FAMILIES)
        assert (pattern.contact[:, 0] == before.contact[:, 0]).all()
        assert (pattern.contact[:, -1] == after.contact[:, -1]).all()
        assert pattern.changes <= found[0].info["objective"] + 1
        assert not pattern.cyclic


def test_the_roles_of_a_transition_come_from_the_gaits_beside_it(hexapod):
    six, four = synthesize_gait_pattern(hexapod), synthesize_gait_pattern(hexapod, locomotive=FOUR)
    into = synthesize_transition_pattern(hexapod, six, four)
    assert not into.contact[[0, 3], -2:].any(), "limbs that stop walking swing in the last two columns"
    out_of = synthesize_transition_pattern(hexapod, four, six)
    assert not out_of.contact[[0, 3], :2].any(), "limbs that begin to walk swing in the first two"
    stays = synthesize_transition_pattern(hexapod, four, four, columns=12)
    assert not stays.contact[[0, 3]].any()


@dataclass
class Plan:
    """Something with a pattern, as a motion plan is."""

    pattern: object


def test_a_transition_takes_plans_as_well_as_patterns_and_other_columns_to_leave_and_enter(hexapod):
    six, five = synthesize_gait_pattern(hexapod), synthesize_gait_pattern(hexapod, locomotive=hexapod.limb_names[1:])
    usual = synthesize_transition_pattern(hexapod, Plan(six), Plan(five))
    assert (usual.contact == synthesize_transition_pattern(hexapod, six, five).contact).all()
    other = synthesize_transition_pattern(hexapod, six, five, from_column=6, to_column=3)
    assert (other.contact[:, 0] == six.contact[:, 6]).all()
    assert (other.contact[:, -1] == five.contact[:, 3]).all()
    assert (other.info["from_column"], other.info["to_column"]) == (6, 3)


def test_a_transition_from_a_stand_begins_where_the_stand_ends(hexapod):
    six, stand = synthesize_gait_pattern(hexapod), stand_pattern(hexapod, 4)
    starting = synthesize_transition_pattern(hexapod, stand, six, columns=8)
    assert starting.contact[:, 0].all()
    assert (starting.contact[:, -1] == six.contact[:, -1]).all()


def test_a_stand_has_swings_at_its_ends_only(hexapod):
    stand = stand_pattern(hexapod, 6, swing_first=["L1"], swing_last=["R2"], free=["R3"])
    assert stand.row("L1").tolist() == [False] * 2 + [True] * 4
    assert stand.row("R2").tolist() == [True] * 4 + [False] * 2
    assert not stand.row("R3").any()
    assert stand.row("L2").all()
    assert not stand.cyclic
    with pytest.raises(InputError, match="L9"):
        stand_pattern(hexapod, 6, free=["L9"])


def test_a_limb_may_be_named_by_what_it_carries(dodecapod):
    tool = next(t for t in dodecapod.tools if t.kind == "camera")
    rest = [n for n in dodecapod.limb_names if n != tool.limb]
    by_tool = transition_problem(
        dodecapod, stand_pattern(dodecapod, 4, free=[tool.name]), stand_pattern(dodecapod, 4), 8
    )
    assert by_tool.locomotive_before == tuple(rest)


def test_a_wave_or_a_tripod_can_be_asked_for_and_says_why_when_it_does_not_do(hexapod, quadruped):
    wave = synthesize_gait_pattern(hexapod, method="wave")
    assert wave.source == "wave"
    assert wave.columns == 18
    assert not broken(hexapod, wave)
    with pytest.raises(InfeasibleFootfall) as caught:
        synthesize_gait_pattern(quadruped, method="tripod")
    assert "g8" in caught.value.explain["families"]
    with pytest.raises(InfeasibleFootfall) as caught:
        synthesize_gait_pattern(hexapod, locomotive=("L3", "R1", "R2", "R3"), method="wave")
    assert caught.value.explain["families"] == ["g9"]
    assert [d["family"] for d in caught.value.explain["demands"]] == ["g9"]


def test_the_program_finds_no_more_changes_than_the_tripod_has(hexapod):
    program = synthesize_gait_pattern(hexapod, method="program")
    assert program.info["objective"] == synthesize_gait_pattern(hexapod).changes


def test_where_the_program_has_too_few_columns_the_wave_takes_its_own_and_says_so(quadruped):
    pattern = synthesize_gait_pattern(quadruped, columns=11)
    assert pattern.source == "wave"
    assert pattern.columns == 12
    assert pattern.relaxed == ("12 columns instead of 11",)


def test_two_lost_left_limbs_name_the_side_and_the_swing_duty(hexapod):
    with pytest.raises(InfeasibleFootfall) as caught:
        synthesize_gait_pattern(hexapod, locomotive=("L3", "R1", "R2", "R3"))
    assert caught.value.explain["families"] == ["g5", "g9"]
    assert "left" in caught.value.explain["advice"]


@pytest.mark.parametrize("names", [("L1", "R1", "R2"), ("L1",), ()])
@pytest.mark.parametrize("method", ["auto", "program", "wave", "tripod"])
def test_fewer_than_four_limbs_have_no_gait_by_any_method(hexapod, names, method):
    with pytest.raises(InfeasibleFootfall) as caught:
        synthesize_gait_pattern(hexapod, locomotive=names, method=method)
    assert "g8" in caught.value.explain["families"]


@pytest.mark.parametrize(
    ("arguments", "found"),
    [
        ({"locomotive": ("L1", "tail", "L9")}, ["'tail'", "'L9'"]),
        ({"columns": 0}, ["0"]),
        ({"method": "trot"}, ["'trot'"]),
    ],
)
def test_bad_arguments_are_refused_by_name(hexapod, arguments, found):
    with pytest.raises(InputError) as caught:
        synthesize_gait_pattern(hexapod, **arguments)
    assert [p.found for p in caught.value.problems] == found


def test_patterns_of_another_robot_and_columns_that_are_not_there_are_refused(hexapod, quadruped):
    six, four = synthesize_gait_pattern(hexapod), synthesize_gait_pattern(quadruped)
    for before, arguments, key in (
        (four, {}, "before"),
        ("tripod", {}, "before"),
        (six, {"from_column": 12}, "from_column"),
    ):
        with pytest.raises(InputError) as caught:
            synthesize_transition_pattern(hexapod, before, six, **arguments)
        assert caught.value.problems[0].key == key


def test_the_same_seed_gives_the_same_candidates(hexapod):
    names = hexapod.limb_names[1:]
    first, second = (gait_pattern_candidates(hexapod, locomotive=names, seed=5) for _ in range(2))
    assert [p.contact.tobytes() for p in first] == [p.contact.tobytes() for p in second]


def test_families_may_be_given_as_the_config_gives_them(hexapod):
    chosen = {c.key: c for c in default_constraints()} | {"gap": GapRule(0), "g8": StanceCount(at_least=4)}
    pattern = synthesize_gait_pattern(hexapod, constraints=chosen, columns=15, method="program")
    problem = gait_problem(hexapod, None, 15)
    assert not check_pattern(pattern.contact, problem, with_problem_families(chosen))
    assert pattern.contact.sum(axis=0).min() >= 4


def rear_stance():
    """The family that docs/footfall.md adds, as it stands there."""
    page = (Path(__file__).parents[2] / "docs" / "footfall.md").read_text()
    (source,) = (block for block in re.findall(r"```python\n(.*?)```", page, re.DOTALL) if "class RearStance" in block)
    names = {"__name__": "rear"}
    exec(source, names)
    return names["RearStance"]()


@dataclass(frozen=True)
class BeginsStanding(GeneralConstraint):
    """g13: everyone stands in column 0, and L1 and R1 never swing together."""

    key: ClassVar[str] = "g13"
    title: ClassVar[str] = "begins standing"
    equation: ClassVar[str] = "C_i0 = 1, C_0j + C_3j ≥ 1"

    def write(self, program):
        for i in range(len(program.problem.limbs)):
            program.clause([program.contact(i, 0)], [], self.key)
        for j in range(program.problem.columns):
            program.clause([program.contact(0, j), program.contact(3, j)], [], self.key)

    def violations(self, contact, problem):
        wrong = not contact[:, 0].all() or bool((~contact[0] & ~contact[3]).any())
        return [self.violation(problem, [], [0], "g13")] if wrong else []


@pytest.mark.parametrize("family", [rear_stance(), BeginsStanding()])
def test_a_family_from_outside_is_one_class(hexapod, family):
    families = (*default_constraints(), family)
    problem = gait_problem(hexapod, None, 12)
    for pattern in gait_pattern_candidates(hexapod, constraints=families):
        there = replace(problem, columns=pattern.columns)
        assert not check_pattern(pattern.contact, there, with_problem_families(families))
