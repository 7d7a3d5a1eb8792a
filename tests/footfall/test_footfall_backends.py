"""Every backend of the general model gives the same answer; out of time or interrupted, the best so far."""

import importlib.util
import multiprocessing
import os
import signal
import sys
import threading
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from small_problems import DODECAPOD, DODECAPOD_SIDES, HEXAPOD, gait, transition, without_gap

from gaitforge.errors import InfeasibleFootfall, InputError, UnsolvedError
from gaitforge.footfall.constraints import GapRule, StanceCount, SupportSectors
from gaitforge.footfall.model import build_program, check_pattern
from gaitforge.footfall.search import SearchOptions, solve
from gaitforge.footfall.solvers import mathopt
from gaitforge.footfall.solvers.base import Solution
from gaitforge.footfall.solvers.cpsat import CpSat
from gaitforge.footfall.solvers.gurobi import Gurobi
from gaitforge.footfall.solvers.mathopt import MathOpt

needs_gurobi = pytest.mark.skipif(importlib.util.find_spec("gurobipy") is None, reason="gurobipy is not installed")
BACKENDS = [
    pytest.param(CpSat(), id="cpsat"),
    pytest.param(MathOpt("highs"), id="highs"),
    pytest.param(MathOpt("scip"), id="scip"),
    pytest.param(Gurobi(), id="gurobi", marks=needs_gurobi),
]
FEET = np.array([[x, y] for y in (0.2, -0.2) for x in (0.25, 0.0, -0.25)])
FOUR = HEXAPOD[1:3] + HEXAPOD[4:6]
THREE = gait(("L1", "L2", "R1"), 9, ("L1", "L2", "R1"), ("left", "left", "right"))
WITH_GAPS = (*(StanceCount(2) if f.key == "g8" else f for f in without_gap() if f.key != "g10"), GapRule())
SLOW = gait(HEXAPOD[1:], 10), (*without_gap(), GapRule(5))
"""Σ y = 6; HiGHS and SCIP need minutes for the proof with the exact program."""


def standing(problem, p=(0.0, 0.0)):
    return replace(problem, footholds=FEET, center_of_mass=np.array(p))


INSTANCES = {
    "tripod": (gait(HEXAPOD), without_gap(), 2),
    "five limbs": (gait(HEXAPOD[1:], 9), without_gap(), 3),
    "three limbs with gaps": (THREE, WITH_GAPS, 6),
    "tripod with g11": (standing(gait(HEXAPOD, 8)), (*without_gap(), SupportSectors(0.08)), 2),
    "five limbs with g11": (standing(gait(HEXAPOD[1:], 10), (-0.07, 0.0)), (*without_gap(), SupportSectors(0.01)), 3),
    "transition": (transition("010101", "011011", 11), without_gap(), 2),
    "transition with g11": (standing(transition("111111", "101110", 8)), (*without_gap(), SupportSectors(0.02)), 3),
    "transition with gaps": (transition("111111", "101110", 8), (*without_gap(), GapRule(6)), 4),
    "losing a limb": (transition("101010", "011110", 9, HEXAPOD, HEXAPOD[1:]), without_gap(), 2),
    "corner lost over fixed feet": (standing(gait(HEXAPOD[1:], 9)), (*without_gap(), SupportSectors(0.02)), None),
    "two columns too few": (gait(FOUR, 7), without_gap(), None),
    "boundary columns that stand on two": (transition("110000", "111111", 6), without_gap(), None),
}


@pytest.mark.parametrize("name", INSTANCES)
@pytest.mark.parametrize("backend", BACKENDS)
def test_every_backend_has_the_same_optimum(backend, name):
    problem, families, changes = INSTANCES[name]
    solution = backend.minimize(build_program(problem, families), 60.0, 1)
    assert solution.objective == changes
    if changes is None:
        assert solution.status == "infeasible"
        assert solution.contact is None
        return
    assert solution.status == "optimal"
    assert solution.bound == changes
    assert solution.gap == 0.0
    assert not check_pattern(solution.contact, problem, families)


@pytest.mark.parametrize("backend", BACKENDS)
def test_status_bound_gap_and_both_times_are_reported_apart(backend):
    pattern = solve(gait(HEXAPOD[1:], 9), without_gap(), SearchOptions(backend))
    assert (pattern.info["status"], pattern.info["bound"], pattern.info["gap"]) == ("optimal", 3, 0.0)
    assert pattern.info["solver"] == backend.name
    assert pattern.info["build_s"] > 0
    assert pattern.info["solve_s"] > 0


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_clash_is_explained_whatever_the_backend(backend):
    with pytest.raises(InfeasibleFootfall) as caught:
        solve(*INSTANCES["corner lost over fixed feet"][:2], SearchOptions(backend))
    assert "g11" in caught.value.explain["families"]


@pytest.mark.parametrize("backend", BACKENDS[1:])
def test_a_backend_lists_what_cpsat_lists(backend):
    problem = gait(("L1", "R1", "L2", "R2"), 4, ("L1", "L2", "R1", "R2"), ("left",) * 2 + ("right",) * 2)
    families = [f for f in without_gap() if f.key in ("roles", "g1", "g8", "g9", "g10")]
    program = build_program(problem, families)
    expected, found = (
        b.listing(program, most_changes=2, limit=1000, time_limit_s=60, seed=0) for b in (CpSat(), backend)
    )
    assert expected.complete
    assert found.complete
    assert {c.tobytes() for c in found.contacts} == {c.tobytes() for c in expected.contacts}
    assert len(found.contacts) == len(expected.contacts) > 10
    few = backend.listing(program, most_changes=2, limit=3, time_limit_s=60, seed=0)
    assert len({c.tobytes() for c in few.contacts}) == 3
    assert not few.complete


@pytest.mark.parametrize("backend", BACKENDS)
def test_feasibility_is_told_without_an_optimum(backend):
    assert backend.is_feasible(build_program(*INSTANCES["transition"][:2]), 60.0, 0) is True
    assert backend.is_feasible(build_program(*INSTANCES["two columns too few"][:2]), 60.0, 0) is False


def large(columns=30):
    """A problem whose optimum takes a while to prove."""
    names = tuple(f"{side}{i}" for side in "LR" for i in range(1, 13))
    sides = ("left",) * 12 + ("right",) * 12
    return transition("1" * 24, "1" * 24, columns, names, names, names, sides)


@pytest.mark.parametrize("backend", [CpSat(), MathOpt("highs"), MathOpt("scip")], ids=lambda b: b.name)
def test_without_time_for_a_pattern_the_search_is_unsolved(backend):
    with pytest.raises(UnsolvedError):
        solve(large(), (*without_gap(), GapRule(24)), SearchOptions(backend, time_limit_s=2e-3))


def test_out_of_time_the_best_pattern_is_returned_with_its_gap():
    problem, families = gait(DODECAPOD, 14, DODECAPOD, DODECAPOD_SIDES), (*without_gap(), GapRule(12))
    pattern = solve(problem, families, SearchOptions(MathOpt("highs"), time_limit_s=8.0))
    assert not check_pattern(pattern.contact, problem, families)
    info = pattern.info
    assert info["objective"] == pattern.changes
    assert 0 < info["bound"] <= info["objective"]
    assert (info["status"] == "optimal") == (info["bound"] == info["objective"])  # a fast machine proves it in time
    assert info["gap"] == (info["objective"] - info["bound"]) / info["objective"]


def test_the_gap_is_relative_to_the_pattern_and_absent_without_one():
    assert Solution("feasible", np.ones((1, 1), dtype=bool), 4, 3).gap == 0.25
    assert Solution("unknown", bound=2).gap is None


def interrupted(search, *arguments):
    """What `search` returns in a process of its own, where Ctrl-C leaves nothing behind for other tests."""
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        return pool.submit(search, *arguments).result(timeout=300)


def press_ctrl_c(seconds):
    """Press it after some seconds of processor time, in this very process: a busy machine changes nothing."""
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a session started in the background ignores it
    start = time.process_time()

    def wait_and_press():
        while time.process_time() - start < seconds:
            time.sleep(0.02)
        os.kill(os.getpid(), signal.SIGINT)

    threading.Thread(target=wait_and_press, daemon=True).start()


def interrupted_backend(backend):
    mathopt.FIRST_TRY = 3.0
    problem, families = SLOW
    program = build_program(problem, (*families, GapRule(5)))
    backend.is_feasible(build_program(THREE, ()), 1.0, 0)  # its library is imported before the clock runs
    press_ctrl_c(4.0)
    return backend.minimize(program, 40.0, 0)


def interrupted_cpsat(after):
    program, backend = build_program(large(60), (*without_gap(), GapRule(24))), CpSat(lean_time_s=1.2)
    backend.is_feasible(build_program(THREE, ()), 1.0, 0)  # ortools is imported
    build_time = CpSat().minimize(program, 1e-3, 0).build_s
    press_ctrl_c(after + build_time)
    return backend.minimize(program, 30.0, 0)


@pytest.mark.parametrize(
    "backend", [MathOpt("highs"), pytest.param(Gurobi(), marks=needs_gurobi)], ids=lambda b: b.name
)
def test_ctrl_c_ends_a_search_with_the_best_pattern_so_far(backend):
    problem, families = SLOW
    solution = interrupted(interrupted_backend, backend)
    assert solution.solve_s < 35  # its time limit is 40
    assert solution.bound <= solution.objective
    assert not check_pattern(solution.contact, problem, families)


@pytest.mark.parametrize("after", [0.8, 2.0])
def test_ctrl_c_ends_cpsat_in_either_of_its_tries(after):
    timed = interrupted(interrupted_cpsat, after)
    assert timed.solve_s < 25  # its time limit is 30
    assert timed.status in ("unknown", "feasible")


def test_gurobi_without_its_package_says_so(monkeypatch):
    monkeypatch.setitem(sys.modules, "gurobipy", None)
    with pytest.raises(InputError, match="gurobipy"):
        solve(gait(HEXAPOD), without_gap(), SearchOptions(Gurobi()))


@needs_gurobi
def test_a_problem_larger_than_the_licence_of_gurobi_says_so():
    with pytest.raises(InputError, match="licence"):
        Gurobi().minimize(build_program(large(40), without_gap()), 5.0, 0)


@pytest.mark.parametrize(
    ("made", "key"), [(lambda: MathOpt("cplex"), "backend"), (lambda: Gurobi(0), "footfall/solver.threads")]
)
def test_bad_settings_are_refused_by_name(made, key):
    with pytest.raises(InputError) as caught:
        made()
    assert caught.value.problems[0].key == key


def test_the_options_of_the_config_are_these_backends():
    group = Path(__file__).parents[2] / "conf" / "footfall" / "solver"
    made = {"highs": MathOpt("highs"), "scip": MathOpt("scip"), "gurobi": Gurobi()}
    for name, expected in made.items():
        node = yaml.safe_load((group / f"{name}.yaml").read_text())
        target = node.pop("_target_")
        assert target == f"{type(expected).__module__}.{type(expected).__name__}"
        assert type(expected)(**node) == expected
