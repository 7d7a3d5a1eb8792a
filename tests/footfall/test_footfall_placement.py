"""Placement: footholds in reach, a centre of mass that is exact, margins that shapely confirms."""

from functools import cache
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.lost_limbs import shapely_margin
from gaitforge.errors import InfeasibleFootfall
from gaitforge.footfall.constraints import SupportSectors, default_constraints, with_problem_families
from gaitforge.footfall.from_robot import gait_problem
from gaitforge.footfall.model import check_pattern
from gaitforge.footfall.placement.place import placed_pattern, prepared
from gaitforge.footfall.placement.reach import JOINT_MARGIN, reach_of
from gaitforge.footfall.placement.spread import Cases, Stance, centers_of, margin_of, spread
from gaitforge.footfall.search import SearchOptions
from gaitforge.footfall.synthesis import synthesize_gait_pattern, synthesize_transition_pattern
from gaitforge.robot.load import load_robot

FAMILIES = (*with_problem_families(None), SupportSectors())


loaded = cache(load_robot)


@pytest.fixture(scope="module")
def hexapod():
    return loaded("hexapod")


@pytest.fixture(scope="module")
def dodecapod():
    return loaded("dodecapod")


def without(robot, *lost):
    return [n for n in robot.limb_names if n not in lost]


@pytest.mark.parametrize("lost", [("L2",), ("R3",), ("L1", "R2"), ("L2", "R2")])
def test_a_hexapod_without_some_limbs_has_the_margin_that_its_pattern_reports(hexapod, lost):
    problem = gait_problem(hexapod, without(hexapod, *lost), 12)
    pattern = placed_pattern(hexapod, problem, FAMILIES, SearchOptions())
    assert shapely_margin(pattern) == pytest.approx(pattern.info["support_margin_m"], abs=1e-6)
    assert pattern.info["support_margin_m"] >= pattern.info["delta_m"]
    assert not check_pattern(pattern.contact, problem, with_problem_families(None))
    assert ("sway_m" in pattern.info) == (len(lost) == 2), "four feet in turn share no point with a margin"
    relaxed = " ".join(pattern.relaxed)
    assert ("instead of 20 mm" in relaxed) == (pattern.info["delta_m"] < 0.02)
    assert ("sways" in relaxed) == ("sway_m" in pattern.info)


def test_the_posture_of_a_pattern_stands_on_its_footholds_under_its_centre_of_mass(hexapod):
    problem = gait_problem(hexapod, without(hexapod, "L2"), 12)
    info = placed_pattern(hexapod, problem, FAMILIES, SearchOptions()).info
    assert list(info["posture_rad"]) == without(hexapod, "L2")
    joints, base = np.array(hexapod.nominal.held_posture), np.zeros(6)
    base[2] = hexapod.nominal.body_height
    for name, values in info["posture_rad"].items():
        joints[hexapod.joint_indices(hexapod.limb(name))] = values
    walking = [hexapod.limb_names.index(name) for name in info["posture_rad"]]
    feet = hexapod.foot_positions(base, joints)[walking]
    assert feet[:, :2] == pytest.approx(np.array(info["footholds_m"])[walking], abs=2e-5)
    assert feet[:, 2] == pytest.approx(hexapod.limbs[0].foot.radius, abs=2e-5)
    assert hexapod.center_of_mass(base, joints)[:2] == pytest.approx(info["center_of_mass_m"], abs=2e-5)


def test_a_body_that_sways_has_no_one_posture(hexapod):
    problem = gait_problem(hexapod, without(hexapod, "L2", "R2"), 12)
    info = placed_pattern(hexapod, problem, FAMILIES, SearchOptions()).info
    assert "sway_m" in info
    assert "posture_rad" not in info


@settings(max_examples=15, deadline=None, derandomize=True)
@given(lost=st.sets(st.sampled_from(tuple(f"{s}{i}" for s in "LR" for i in range(1, 7))), min_size=1, max_size=4))
def test_a_dodecapod_without_up_to_four_limbs_has_the_margin_asked_for(lost):
    robot = loaded("dodecapod")
    problem = gait_problem(robot, without(robot, *lost), 12)
    pattern = placed_pattern(robot, problem, FAMILIES, SearchOptions())
    assert pattern.info["delta_m"] == 0.02
    assert shapely_margin(pattern) == pytest.approx(pattern.info["support_margin_m"], abs=1e-6)
    assert shapely_margin(pattern) >= 0.02


def test_placed_feet_are_where_the_posture_puts_them_and_so_is_the_centre_of_mass(hexapod):
    problem = gait_problem(hexapod, without(hexapod, "L1"), 12)
    ready = prepared(hexapod, problem, FAMILIES, SearchOptions())
    reach = reach_of(hexapod, problem)
    offsets = ready.problem.footholds - reach.footholds
    assert np.abs(offsets).max() > 0.005
    assert not offsets[0].any(), "a limb that does not walk is not placed"
    joints = reach.posture(offsets)
    base = np.array([0, 0, hexapod.nominal.body_height, 0, 0, 0])
    feet = hexapod.foot_positions(base, joints)
    nominal = hexapod.foot_positions(base, reach.joints)
    assert feet[:, :2] == pytest.approx(ready.problem.footholds, abs=1e-4)
    assert feet[:, 2] == pytest.approx(nominal[:, 2], abs=1e-4)
    assert hexapod.center_of_mass(base, joints)[:2] == pytest.approx(ready.problem.center_of_mass, abs=1e-9)
    walking = np.concatenate([hexapod.joint_indices(hexapod.limbs[i]) for i in reach.walking])
    assert (joints[walking] >= hexapod.lower[walking] + JOINT_MARGIN - 1e-9).all()
    assert (joints[walking] <= hexapod.upper[walking] - JOINT_MARGIN + 1e-9).all()


def test_neighbouring_feet_keep_apart_and_in_order(hexapod):
    for lost in ((), ("L1",), ("L2", "R3")):
        pattern = placed_pattern(hexapod, gait_problem(hexapod, without(hexapod, *lost), 12), FAMILIES, SearchOptions())
        ahead = np.array(pattern.info["footholds_m"])[:, 0].reshape(2, 3)
        assert (-np.diff(ahead, axis=1) >= 0.8 * 0.125 - 2e-4).all()


def test_the_derivative_of_the_centre_of_mass_is_that_of_the_posture(hexapod):
    reach = reach_of(hexapod, gait_problem(hexapod, None, 12))
    rng = np.random.default_rng(4)
    offsets = rng.uniform(-0.01, 0.01, (6, 2))
    linear = centers_of(reach, Stance(offsets, np.zeros((1, 2))))[0]
    assert linear == pytest.approx(reach.center_of_mass_at(offsets), abs=2e-4)
    assert np.abs(linear - reach.center_of_mass).max() > 2e-4


@settings(max_examples=10, deadline=None, derandomize=True)
@given(seed=st.integers(0, 1000))
def test_spreading_never_makes_a_margin_smaller_and_stays_in_reach(seed):
    robot = loaded("hexapod")
    reach = reach_of(robot, gait_problem(robot, None, 12))
    rng = np.random.default_rng(seed)
    contact = np.zeros((6, 3), dtype=bool)
    for j in range(3):
        contact[rng.choice(6, size=int(rng.integers(3, 6)), replace=False), j] = True
    for cases in (Cases.still(contact), Cases.swaying(contact, [0, 1, 2], True)):
        begin = Stance(np.zeros((6, 2)), np.zeros((cases.count, 2)))
        before = margin_of(cases, reach.footholds, centers_of(reach, begin))
        stance, after = spread(reach, cases, begin.offsets, 0.05)
        assert after >= before
        for shift in stance.shifts:
            moved = np.einsum("ird,id->ir", reach.normals, stance.offsets - shift)
            assert (moved <= reach.extents + 1e-7).all()


def test_a_body_that_stays_and_four_limbs_in_turn_have_no_margin_whatever_the_feet(hexapod):
    problem = gait_problem(hexapod, without(hexapod, "L2", "R2"), 12)
    reach = reach_of(hexapod, problem)
    walking = list(reach.walking)
    contact = np.zeros((6, 4), dtype=bool)
    for j, three in enumerate(combinations(walking, 3)):
        contact[list(three), j] = True
    _, still = spread(reach, Cases.still(contact), np.zeros((6, 2)), 0.05)
    _, swaying = spread(reach, Cases.swaying(contact, range(4), True), np.zeros((6, 2)), 0.05)
    assert still < 1e-6
    assert swaying > still


@pytest.mark.parametrize(("lost", "families"), [(("L1", "L2"), ["g5", "g9"]), (("L1", "R1", "L2"), ["g5", "g8"])])
def test_where_the_other_families_clash_already_g11_is_not_blamed(hexapod, lost, families):
    with pytest.raises(InfeasibleFootfall) as caught:
        synthesize_gait_pattern(
            hexapod, locomotive=without(hexapod, *lost), constraints=(*default_constraints(), SupportSectors())
        )
    assert caught.value.explain["families"] == families


@pytest.mark.parametrize("lost", [(), ("L1",), ("L1", "R3")])
def test_synthesis_with_g11_places_the_feet_and_keeps_every_family(hexapod, lost):
    pattern = synthesize_gait_pattern(
        hexapod, locomotive=without(hexapod, *lost), constraints=(*default_constraints(), SupportSectors())
    )
    problem = gait_problem(hexapod, without(hexapod, *lost), pattern.columns)
    assert not check_pattern(pattern.contact, problem, with_problem_families(None))
    assert shapely_margin(pattern) == pytest.approx(pattern.info["support_margin_m"], abs=1e-6)
    assert shapely_margin(pattern) >= pattern.info["delta_m"] > 0


def test_a_margin_nobody_can_have_names_g11(dodecapod):
    far = (*default_constraints(), SupportSectors(delta=2.0, fallback=()))
    with pytest.raises(InfeasibleFootfall) as caught:
        synthesize_gait_pattern(dodecapod, constraints=far)
    assert "g11" in caught.value.explain["families"]


def test_a_transition_reports_the_margin_that_placed_feet_give_it(hexapod):
    families = (*default_constraints(), SupportSectors())
    six = synthesize_gait_pattern(hexapod, constraints=families)
    five = synthesize_gait_pattern(hexapod, locomotive=without(hexapod, "L2"), constraints=families)
    move = synthesize_transition_pattern(hexapod, six, five, constraints=families)
    assert len(move.info["sway_m"]) == move.columns + 1
    assert shapely_margin(move) == pytest.approx(move.info["support_margin_m"], abs=1e-6)
