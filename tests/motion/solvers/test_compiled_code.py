"""Compiled code gives what interpreted code gives, is made once, and is never needed."""

from __future__ import annotations

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from scipy import sparse

from gaitforge.motion.plan import Command
from gaitforge.motion.solvers import native
from gaitforge.motion.solvers.factor import Qdldl, factor_of, minimum_degree
from gaitforge.motion.solvers.generated import kernel_library
from gaitforge.motion.solvers.structured import Structured
from gaitforge.motion.solvers.supernodal import Supernodal
from gaitforge.motion.solvers.supernodes import find_supernodes
from gaitforge.motion.solvers.workspace import forget, workspace_of
from gaitforge.robot.model import RobotModel
from tests.motion.motion_kit import PATIENT, TRIPOD, gait_segment

needs_compiler = pytest.mark.skipif(native.library("ldl.c") is None, reason="no C compiler")


def clear() -> None:
    """Forget what was compiled in this process."""
    native.library.cache_clear()
    kernel_library.cache_clear()


def random_kkt(seed: int, variables: int, rows: int) -> sparse.csc_matrix:
    """The upper triangle of a sparse quasi-definite matrix."""
    rng = np.random.default_rng(seed)
    hessian = sparse.random(variables, variables, 0.05, random_state=seed)
    jacobian = sparse.random(rows, variables, 0.1, random_state=seed + 1)
    top = hessian @ hessian.T + sparse.diags(rng.uniform(0.5, 2.0, variables))
    full = sparse.bmat([[top, jacobian.T], [jacobian, -sparse.diags(rng.uniform(1e-6, 1.0, rows))]])
    upper = sparse.triu(full, format="csc")
    upper.sort_indices()
    return upper


@needs_compiler
@pytest.mark.parametrize("seed", range(8))
def test_panels_solve_what_qdldl_and_a_dense_solver_solve(seed: int) -> None:
    upper = random_kkt(seed, 10 + 30 * seed, 1 + 12 * seed)
    indices, indptr = upper.indices.astype(np.int32), upper.indptr.astype(np.int32)
    ours, theirs = factor_of(indices, indptr, native=True), Qdldl(indices, indptr)
    assert isinstance(ours, Supernodal)
    full = upper.toarray() + np.triu(upper.toarray(), 1).T
    right = np.random.default_rng(seed).normal(size=len(full))
    for scale in (1.0, 3.0):  # refactored in place
        negative = ours.factor(scale * upper.data)
        assert negative == theirs.factor(scale * upper.data) == (np.linalg.eigvalsh(full) < 0).sum()
        expected = np.linalg.solve(scale * full, right)
        assert ours.solve(right) == pytest.approx(expected, rel=1e-6, abs=1e-8)
        assert theirs.solve(right) == pytest.approx(expected, rel=1e-6, abs=1e-8)


@needs_compiler
@pytest.mark.parametrize("lanes", [2, 4, 8])
@pytest.mark.parametrize("size", [15, 16, 17, 40, 131])
def test_wide_panels_are_the_same_whatever_the_processor_can_do_at_once(lanes: int, size: int) -> None:
    rng = np.random.default_rng(size)
    half, rows = rng.normal(size=(size, size)), size // 3
    top = half @ half.T / size + np.eye(size)
    right, jacobian = rng.normal(size=size + rows), rng.normal(size=(rows, size)) / size
    full = np.block([[top, jacobian.T], [jacobian, -0.5 * np.eye(rows)]])
    upper = sparse.csc_matrix(np.triu(full))
    source = Path(native.__file__).with_name("ldl.c").read_text(encoding="utf-8")
    numeric, symbolic = native.compiled("ldl", f"#define LANES {lanes}\n{source}", "-O2"), native.library("symbolic.c")
    assert numeric is not None
    assert symbolic is not None
    order = np.random.default_rng(lanes).permutation(len(full))
    factor = Supernodal(find_supernodes(upper.indices, upper.indptr, order, symbolic), numeric)
    assert factor.factor(upper.data) == rows
    assert factor.solve(right) == pytest.approx(np.linalg.solve(full, right), rel=1e-9, abs=1e-11)


@needs_compiler
def test_a_zero_pivot_is_a_failure_and_not_a_number() -> None:
    indices, indptr = np.array([0, 0, 1], dtype=np.int32), np.array([0, 1, 3], dtype=np.int32)
    factor = factor_of(indices, indptr, native=True)
    assert isinstance(factor, Supernodal)
    assert factor.factor(np.array([1.0, 1.0, 1.0])) is None
    assert factor.factor(np.array([1.0, 2.0, 1.0])) == 1


def test_minimum_degree_orders_every_column_whether_or_not_its_diagonal_is_stored() -> None:
    for seed in range(20):
        upper = sparse.triu(random_kkt(seed, 60, 20), k=seed % 2, format="csc")
        order = minimum_degree(upper.indices, upper.indptr)
        assert sorted(order.tolist()) == list(range(80))


@needs_compiler
@pytest.mark.parametrize("seed", range(6))
def test_supernodes_store_every_entry_of_the_factor_once(seed: int) -> None:
    upper, library = random_kkt(seed, 10 + 20 * seed, 1 + 8 * seed), native.library("symbolic.c")
    assert library is not None
    amd = minimum_degree(upper.indices, upper.indptr)
    nodes = find_supernodes(upper.indices, upper.indptr, amd, library)
    assert sorted(nodes.order.tolist()) == list(range(len(amd)))
    needed = eliminated(upper, nodes.order)
    assert len(needed) == len(eliminated(upper, amd)), "the postorder fills in as much"
    stored = {
        (int(row), column)
        for s in range(len(nodes.first) - 1)
        for column in range(nodes.first[s], nodes.first[s + 1])
        for row in nodes.rows[nodes.rowptr[s] : nodes.rowptr[s + 1]]
        if row >= column
    }
    assert needed <= stored
    assert len(nodes.first) - 1 < len(amd), "some columns share a panel"
    assert (np.diff(nodes.start) == np.diff(nodes.first) * np.diff(nodes.rowptr)).all()


@needs_compiler
def test_every_entry_of_the_matrix_has_its_place_in_a_panel() -> None:
    upper, library = random_kkt(4, 80, 30), native.library("symbolic.c")
    assert library is not None
    nodes = find_supernodes(upper.indices, upper.indptr, minimum_degree(upper.indices, upper.indptr), library)
    assert sorted(nodes.source.tolist()) == list(range(upper.nnz))
    place = np.argsort(nodes.order)
    owner = np.repeat(np.arange(len(place)), np.diff(upper.indptr))
    a, b = place[upper.indices[nodes.source]], place[owner[nodes.source]]
    node = np.repeat(np.arange(len(nodes.first) - 1), np.diff(nodes.entry))
    column, row = np.divmod(nodes.target, np.diff(nodes.rowptr)[node])
    assert (nodes.first[node] + column == np.minimum(a, b)).all()
    assert (nodes.rows[nodes.rowptr[node] + row] == np.maximum(a, b)).all()


def eliminated(upper: sparse.csc_matrix, order: np.ndarray) -> set[tuple[int, int]]:
    """(row, column) of the entries of L, by the rules of elimination on a dense pattern."""
    filled = (upper.toarray() != 0) | (upper.toarray().T != 0)
    filled = filled[np.ix_(order, order)]
    for k in range(len(order)):
        below = np.flatnonzero(filled[k + 1 :, k]) + k + 1
        filled[np.ix_(below, below)] = True
    return {(int(row), int(column)) for row, column in zip(*np.nonzero(np.tril(filled)), strict=True)}


@needs_compiler
def test_compiled_kernels_give_what_interpreted_ones_give(hexapod: RobotModel) -> None:
    problem, _ = gait_segment(hexapod, TRIPOD, Command(0.05, 0.3, 0.15), r=2).build(PATIENT)
    compiled, interpreted = (workspace_of(problem, native=wanted).evaluation for wanted in (True, False))
    assert compiled is not interpreted
    rng = np.random.default_rng(1)
    x = problem.x0[workspace_of(problem).structure.free]
    x, multipliers = x + 0.01 * rng.normal(size=len(x)), rng.normal(size=problem.row_count)
    for evaluation in (compiled, interpreted):
        evaluation.load(problem)
        evaluation.derivatives(x, multipliers)
    assert compiled.cost == pytest.approx(interpreted.cost, rel=1e-12)
    for name in ("rows", "gradient", "kkt"):
        assert getattr(compiled, name) == pytest.approx(getattr(interpreted, name), rel=1e-10, abs=1e-10)


def test_without_a_compiler_the_same_plan_is_found(
    hexapod: RobotModel, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    problem, _ = gait_segment(hexapod, TRIPOD, Command(0.05)).build(PATIENT)
    here = Structured(fallback=None).solve(problem)
    forget()
    clear()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("CC", "no-such-compiler")
    try:
        bare = Structured(fallback=None).solve(problem)
        assert isinstance(workspace_of(problem).factor, Qdldl)
    finally:
        forget()
        clear()
    asked_not_to = Structured(fallback=None, native=False).solve(problem)
    assert not list(tmp_path.rglob("*.so"))
    for other in (bare, asked_not_to):
        assert other.solved
        assert other.x == pytest.approx(here.x, abs=1e-6)


def test_a_compiler_that_fails_is_as_good_as_none(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("CC", "false")
    assert native.compiled("broken", "this is no C", "-O1") is None
    assert not list(tmp_path.rglob("*.so"))


def test_a_user_without_a_home_has_no_compiled_code(monkeypatch: pytest.MonkeyPatch) -> None:
    def nowhere() -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(Path, "home", nowhere)
    assert native.compiled("eight", "int eight(void) { return 8; }", "-O1") is None


@needs_compiler
def test_many_may_compile_at_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    with ThreadPoolExecutor(4) as pool:
        made = list(pool.map(lambda _: native.compiled("seven", "int seven(void) { return 7; }", "-O1"), range(4)))
    assert [library.seven() for library in made if library is not None] == [7, 7, 7, 7]
    assert len([path for path in tmp_path.rglob("*") if path.is_file()]) == 1, "nothing is left lying about"
    program = (
        "from gaitforge.motion.solvers import native; "
        "print(native.compiled('seven', 'int seven(void) { return 7; }', '-O1').seven())"
    )
    command = [sys.executable, "-c", program]
    monkeypatch.setenv("CC", "no-such-compiler")
    assert subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip() == "7"
