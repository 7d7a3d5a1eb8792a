"""The search over change times: the same optimum as brute force and as the general model, and when it steps aside."""

import subprocess
import sys
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from random_problems import problems
from small_problems import DODECAPOD, DODECAPOD_SIDES, HEXAPOD, HEXAPOD_SIDES, gait, transition, without_gap
from test_footfall_program import least_changes

from gaitforge.errors import InfeasibleFootfall, InputError
from gaitforge.footfall.constraints import (
    ChangeLimit,
    GapRule,
    GeneralConstraint,
    StanceCount,
    default_constraints,
    with_problem_families,
)
from gaitforge.footfall.constraints.g11_support_sectors import SupportSectors
from gaitforge.footfall.model import build_program, check_pattern
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.footfall.search import SearchOptions, solve
from gaitforge.footfall.segments.bound import least_times
from gaitforge.footfall.segments.optimum import kinds_of
from gaitforge.footfall.segments.reading import NotUnderstood, read
from gaitforge.footfall.solvers.cpsat import CpSat
from gaitforge.footfall.solvers.segments import Segments

ROOT = Path(__file__).parents[2]
TWELVE = transition("011111111110", "011011110111", 18, DODECAPOD, DODECAPOD, DODECAPOD, DODECAPOD_SIDES)


def changes(problem, families):
    """Σ y by the search over change times, None for a proof that there is no pattern, "unknown" for neither."""
    solution, _ = Segments().search(problem, families)
    if solution.contact is None:
        return None if solution.status == "infeasible" else "unknown"
    assert not check_pattern(solution.contact, problem, families)
    assert solution.status == "optimal"
    pattern = FootfallPattern(solution.contact, problem.limbs, problem.cyclic)
    assert pattern.changes == solution.objective == solution.bound
    return solution.objective


def by_cpsat(problem, families):
    solution = CpSat().minimize(build_program(problem, families), 30.0, 0)
    assert solution.status in ("optimal", "infeasible")
    return solution.objective


@settings(max_examples=60, deadline=None, derandomize=True)
@given(case=problems(most_limbs=3, most_columns=6))
def test_the_optimum_of_a_tiny_problem_is_that_of_brute_force(case):
    found = changes(*case)
    assert found in ("unknown", least_changes(*case))


@settings(max_examples=200, deadline=None, derandomize=True)
@given(case=problems())
def test_the_optimum_is_that_of_the_general_model(case):
    assert changes(*case) in ("unknown", by_cpsat(*case))


@settings(max_examples=150, deadline=None, derandomize=True)
@given(case=problems())
def test_only_what_g1_leaves_open_is_not_understood_and_the_bound_is_never_too_high(case):
    problem, families = case
    limit = next(f.at_most for f in families if f.key == "g1")
    found = changes(problem, families)
    try:
        reading = read(problem, families)
    except NotUnderstood:
        assert limit == 3
        assert not problem.cyclic
        return
    assert found != "unknown"
    kinds, kind = kinds_of(reading)
    bound = least_times(reading, [kinds[t][1] for t in kind])
    assert found is None or bound <= found


@pytest.mark.parametrize(
    ("problem", "families", "expected"),
    [
        (transition("010101", "011011", 11), without_gap(), 2),
        (TWELVE, without_gap(), 2),
        (TWELVE, [StanceCount(all_but=3) if f.key == "g8" else f for f in without_gap()], 4),
        (gait(HEXAPOD), without_gap(), 2),
        (gait(HEXAPOD[1:]), without_gap(), 3),
        (gait(("L2", "L3", "R2", "R3")), without_gap(), 4),
        (gait(("L2", "L3", "R2", "R3")), with_problem_families(None), 8),
        (gait(DODECAPOD, 40, DODECAPOD, DODECAPOD_SIDES), without_gap(), 2),
    ],
    ids=["6x11", "12x18", "12x18, printed g8", "none free", "one free", "two free", "two free, gaps", "12x40"],
)
def test_known_optima_are_found(problem, families, expected):
    assert changes(problem, families) == expected


def rows_of_feet(limbs, half_width, spacing):
    x = spacing * ((limbs / 2 - 1) / 2 - np.arange(limbs // 2))
    return np.concatenate([np.stack([x, np.full_like(x, y)], axis=1) for y in (half_width, -half_width)])


def test_support_sectors_are_understood_and_cost_the_dodecapod_one_more_change():
    families = (*without_gap(), SupportSectors(delta=0.1))
    assert changes(replace(TWELVE, footholds=rows_of_feet(12, 0.28, 0.12)), families) == 3
    names = tuple(f"{side}{i}" for side in "LR" for i in range(1, 25))
    large = transition("1" * 48, "1" * 48, 40, names, names, names, ("left",) * 24 + ("right",) * 24)
    assert changes(replace(large, footholds=rows_of_feet(48, 0.3, 0.1)), families) == 3


@settings(max_examples=15, deadline=None, derandomize=True)
@given(order=st.permutations(range(12)))
def test_the_order_of_the_rows_does_not_matter(order):
    families = (*without_gap(), SupportSectors(delta=0.1))
    turned = replace(
        TWELVE,
        limbs=tuple(DODECAPOD[i] for i in order),
        sides=tuple(DODECAPOD_SIDES[i] for i in order),
        first=TWELVE.first[list(order)],
        last=TWELVE.last[list(order)],
        footholds=rows_of_feet(12, 0.28, 0.12)[list(order)],
    )
    assert changes(turned, families) == 3


@dataclass(frozen=True)
class TwoOnTheGroundAtFirst(GeneralConstraint):
    """A family that writes its rows itself."""

    key: ClassVar[str] = "g12"
    title: ClassVar[str] = "two stand at first"
    equation: ClassVar[str] = "C_00 + C_10 ≥ 2"

    def write(self, program):
        program.row([(program.contact(0, 0), 1), (program.contact(1, 0), 1)], 2, None, self.name)

    def violations(self, contact, problem):
        return [] if contact[:2, 0].all() else [self.violation(problem, [0, 1], [0], "lifted")]


@pytest.mark.parametrize(
    ("families", "reason"),
    [
        ((*default_constraints(), TwoOnTheGroundAtFirst()), "g12"),
        ((ChangeLimit(4), *default_constraints()[1:]), "two changes"),
        (default_constraints()[1:], "two changes"),
    ],
    ids=["a general family", "more changes", "no g1"],
)
def test_what_it_does_not_understand_goes_to_the_general_model_and_the_pattern_says_so(families, reason):
    families = with_problem_families(families)
    problem = gait(HEXAPOD, 8)
    pattern = solve(problem, families, SearchOptions())
    assert pattern.info["solver"] == "cpsat"
    assert reason in pattern.info["solver_reason"]
    assert pattern.changes == by_cpsat(problem, families)
    assert not check_pattern(pattern.contact, problem, families)


def test_the_solver_is_named_and_can_be_chosen():
    assert solve(gait(HEXAPOD), without_gap(), SearchOptions()).info["solver"] == "segments"
    assert solve(gait(HEXAPOD), without_gap(), SearchOptions(CpSat())).info["solver"] == "cpsat"


@pytest.mark.parametrize("limits", [{"effort": 1}, {"largest": 1}])
def test_what_is_too_large_goes_to_the_general_model_with_the_bound_reached(limits):
    problem, families = gait(HEXAPOD[1:], 9), without_gap()
    solution, reason = Segments(**limits).search(problem, families)
    assert (solution.status, solution.contact, solution.bound) == ("unknown", None, 3)
    pattern = solve(problem, families, SearchOptions(Segments(**limits)))
    assert (pattern.info["solver"], pattern.info["solver_reason"]) == ("cpsat", reason)
    assert (pattern.changes, pattern.info["bound"]) == (3, 3)


def test_a_clash_found_by_the_search_is_explained():
    problem = transition("110011", "001111", 8)
    with pytest.raises(InfeasibleFootfall) as caught:
        solve(problem, with_problem_families([*default_constraints()[:-1], StanceCount(6)]), SearchOptions())
    assert "g8" in caught.value.explain["families"]


def test_dropping_a_family_never_makes_the_optimum_worse():
    families = with_problem_families([*default_constraints()[:-1], GapRule(6)])
    problem = gait(HEXAPOD[1:], 12)
    whole = changes(problem, families)
    assert whole == 6
    for dropped in default_constraints()[1:-1]:
        assert changes(problem, [f for f in families if f != dropped]) <= whole


SCRIPT = """
from small_problems import HEXAPOD, gait, transition, without_gap
from gaitforge.footfall.search import SearchOptions, solve, ties
problem = gait(HEXAPOD[1:])
best = solve(problem, without_gap(), SearchOptions(seed=3))
listed = ties(problem, without_gap(), best, SearchOptions(seed=3))
move = solve(transition("010101", "011011", 11), without_gap(), SearchOptions(seed=3))
print(b"".join(p.contact.tobytes() for p in (best, move, *listed)).hex())
"""


def test_the_same_seed_gives_the_same_patterns_whatever_the_hash_seed():
    path = [str(ROOT), str(Path(__file__).parent)]
    printed = {
        subprocess.run(
            [sys.executable, "-c", f"import sys; sys.path[:0] = {path!r}\n{SCRIPT}"],
            env={"PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("0", "1", "77")
    }
    assert len(printed) == 1
    assert len(printed.pop()) > 2 * 168 * 6 * 12


@pytest.mark.parametrize("wrong", [{"effort": 0}, {"largest": -1}, {"largest": 1.5}])
def test_limits_that_make_no_sense_are_refused(wrong):
    with pytest.raises(InputError) as caught:
        Segments(**wrong)
    assert next(iter(wrong)) in caught.value.problems[0].key


def test_the_config_option_has_the_defaults_of_the_class_and_is_the_default():
    group = ROOT / "conf" / "footfall"
    option = yaml.safe_load((group / "solver" / "segments.yaml").read_text())
    assert option.pop("_target_") == f"{Segments.__module__}.{Segments.__name__}"
    assert option == {f.name: getattr(Segments(), f.name) for f in fields(Segments) if f.name != "general"}
    assert {"solver": "segments"} in yaml.safe_load((group / "default.yaml").read_text())["defaults"]
    assert SearchOptions().solver == Segments()


def test_a_robot_without_limbs_on_one_side_is_no_special_case():
    problem = gait(HEXAPOD[:4], 12, HEXAPOD[:4], (*HEXAPOD_SIDES[:3], "middle"))
    assert changes(problem, without_gap()) == by_cpsat(problem, without_gap()) == 4
