"""The benchmark of footfall patterns: what it measures is checked, and said as it is."""

import numpy as np
import pytest

from benchmarks import footfall
from benchmarks.footfall_cases import Case, families, gaits, growing, transition, transitions
from gaitforge.footfall.model import check_pattern
from gaitforge.footfall.search import SearchOptions, solve
from gaitforge.footfall.segments import optimum
from gaitforge.footfall.segments.placing import Effort
from gaitforge.footfall.solvers.segments import Segments


def test_the_instances_have_their_known_optima_in_any_order_of_the_rows():
    known = {"6 × 11": 2, "12 × 18": 2, "12 × 18 with g11": 3, "12 × 18, printed g8": 4}
    assert {c.name: solve(c.problem, c.families, SearchOptions()).changes for c in transitions()} == known
    for case in (*transitions(), *gaits()):
        order = np.random.default_rng(5).permutation(len(case.problem.limbs))
        here, there = (solve(c.problem, c.families, SearchOptions()) for c in (case, case.with_rows_in(order)))
        assert here.changes == there.changes


def test_the_order_of_the_rows_hardly_changes_how_many_limbs_are_tried(monkeypatch):
    spent = []

    class Counted(Effort):
        def spend(self):
            spent[-1] += 1
            super().spend()

    monkeypatch.setattr(optimum, "Effort", Counted)
    for case in (*transitions(), *gaits()):
        for seed in range(10):
            spent.append(0)
            turned = case.with_rows_in(np.random.default_rng(seed).permutation(len(case.problem.limbs)))
            assert Segments().search(turned.problem, turned.families)[0].status == "optimal"
    assert 0 < min(spent) <= max(spent) <= 60


def test_growth_covers_every_size_with_and_without_g11():
    asked = {(n, m, g11) for n in (4, 6, 8, 12, 24, 48) for m in (10, 20, 40) for g11 in (False, True)}
    assert {(n, m, g11) for n, m, g11, _ in growing()} == asked


def test_a_table_has_a_row_for_each_solver_with_medians_and_ratios():
    lines = footfall.compared(transitions()[:1], {"segments": footfall.by_search(Segments())}, 3, 5.0)
    cells = [cell.strip() for cell in lines[-1].strip("|").split("|")]
    assert cells[:4] == ["6 × 11", "segments", "optimal, 2", "3"]
    assert float(cells[4]) > 0
    assert cells[6] == "1"


def test_a_solver_that_breaks_a_family_is_found_out():
    case = Case("6 × 11", transition("010101", "011011", 11), families())
    wrong = np.ones((6, 11), dtype=bool)
    assert check_pattern(wrong, case.problem, case.families)
    with pytest.raises(RuntimeError, match="breaks a family"):
        footfall.measured(case, "wrong", lambda *_: ("optimal", wrong), 1, 1.0)


def test_a_peer_that_is_not_installed_is_left_out_and_named(monkeypatch):
    monkeypatch.setattr(footfall, "find_spec", lambda name: None)
    runs, missing = footfall.peers()
    assert not [name for name in runs if name.startswith("Gurobi")]
    assert missing == ["Gurobi (package gurobipy)"]
    assert "Skipped, not installed: Gurobi (package gurobipy)." in footfall.versions(missing)
