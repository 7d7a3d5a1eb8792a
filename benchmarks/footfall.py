"""Footfall patterns: the search over change times beside the general model's solvers.

``python -m benchmarks.footfall [--seeds 10] [--limit 20] [--out file.md]``

Times run from problem and families to the answer, building of models included, over several seeds; each
seed also shuffles the order of the rows.  Processor time leads, since wall-clock time of a few
milliseconds says more about what else the machine does.  A peer that is not installed is skipped, and the
page says so.  The page is written to docs/results/footfall_benchmark.md.
"""

from __future__ import annotations

import argparse
import os
import platform
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path
from statistics import median

import numpy as np
from numpy.typing import NDArray

from benchmarks.footfall_cases import Case, families, gait, gaits, growing, transitions
from gaitforge.errors import InputError, UnsolvedError
from gaitforge.footfall.model import check_pattern
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.footfall.search import SearchOptions, solve, ties
from gaitforge.footfall.solvers.base import FootfallSolver
from gaitforge.footfall.solvers.cpsat import CpSat
from gaitforge.footfall.solvers.segments import Segments

PAGE = Path(__file__).parents[1] / "docs" / "results" / "footfall_benchmark.md"
WARM = transitions()[0]
PACKAGES = ("ortools", "gurobipy", "numpy")
Run = Callable[[Case, int, float], tuple[str, NDArray[np.bool_] | None]]
"""(case, seed, time limit [s]) → status and pattern"""


@dataclass(frozen=True)
class Measured:
    """Several runs of one solver on one instance."""

    case: str
    solver: str
    times: tuple[float, ...]
    """[s] of processor, all threads together"""
    walls: tuple[float, ...]
    """[s] by the clock on the wall"""
    statuses: tuple[str, ...]
    changes: tuple[int | None, ...]

    @property
    def median(self) -> float:
        """[s] of processor"""
        return median(self.times)

    @property
    def outcome(self) -> str:
        """Status, and Σ y where all runs agree on it."""
        status = " / ".join(dict.fromkeys(self.statuses))
        found = {c for c in self.changes if c is not None}
        return f"{status}, {' or '.join(map(str, sorted(found)))}" if found else status


def by_search(solver: FootfallSolver) -> Run:
    """The project's own search with one of its solvers."""

    def run(case: Case, seed: int, limit: float) -> tuple[str, NDArray[np.bool_] | None]:
        try:
            pattern = solve(case.problem, case.families, SearchOptions(solver, seed, limit))
        except UnsolvedError:
            return "unsolved", None
        return str(pattern.info["status"]), pattern.contact

    return run


def by_segments(case: Case, _seed: int, _limit: float) -> tuple[str, NDArray[np.bool_] | None]:
    """The search over change times alone: an infeasible problem is proven, not explained."""
    solution, reason = Segments().search(case.problem, case.families)
    return reason or solution.status, solution.contact


def by_quadratic(case: Case, seed: int, limit: float) -> tuple[str, NDArray[np.bool_] | None]:
    """Gurobi with the paper's quadratic form."""
    from benchmarks.gurobi_quadratic import minimize

    solution = minimize(case.problem, case.families, limit, seed)
    return solution.status, solution.contact


def measured(case: Case, name: str, run: Run, seeds: int, limit: float) -> Measured:
    """Runs over seeds and orders of the rows; no new one once two limits are used up."""
    times: list[float] = []
    walls: list[float] = []
    statuses, changes = [], []
    run(WARM, 0, limit)  # imports
    for seed in range(seeds):
        shuffled = case.with_rows_in(np.random.default_rng(seed).permutation(len(case.problem.limbs)))
        start = time.perf_counter(), time.process_time()
        status, contact = run(shuffled, seed, limit)
        times.append(time.process_time() - start[1])
        walls.append(time.perf_counter() - start[0])
        statuses.append(status)
        if contact is not None:
            if check_pattern(contact, shuffled.problem, shuffled.families):
                raise RuntimeError(f"{case.name}, {name}: a pattern that breaks a family")
            changes.append(FootfallPattern(contact, shuffled.problem.limbs, shuffled.problem.cyclic).changes)
        if sum(walls) > 2 * limit:
            break
    return Measured(case.name, name, tuple(times), tuple(walls), tuple(statuses), tuple(changes))


def peers() -> tuple[dict[str, Run], list[str]]:
    """The solvers to compare with, and those that are not installed."""
    from gaitforge.footfall.solvers.gurobi import Gurobi
    from gaitforge.footfall.solvers.mathopt import MathOpt

    runs: dict[str, Run] = {"segments": by_search(Segments()), "CP-SAT": by_search(CpSat())}
    missing = []
    if find_spec("gurobipy") is None:
        missing.append("Gurobi (package gurobipy)")
    else:
        runs["Gurobi, linear"] = by_search(Gurobi())
        runs["Gurobi, quadratic"] = by_quadratic
    runs["HiGHS"] = by_search(MathOpt("highs"))
    runs["SCIP"] = by_search(MathOpt("scip"))
    return runs, missing


def compared(cases: Sequence[Case], runs: dict[str, Run], seeds: int, limit: float) -> list[str]:
    """A table of solvers on instances, with ratios to the search over change times."""
    lines = [
        "| instance | solver | status, Σ y | runs | median [ms] | min – max [ms] | × segments | wall [ms] |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for case in cases:
        base = None
        for name, run in runs.items():
            if name == "Gurobi, quadratic" and case.name != "6 × 11":
                continue
            try:
                found = measured(case, name, run, seeds, limit)
            except InputError as error:  # the size-limited licence
                lines.append(f"| {case.name} | {name} | not run: {error.problems[0].found} | | | | | |")
                continue
            base = base or found.median
            span = f"{1e3 * min(found.times):.2f} – {1e3 * max(found.times):.2f}"
            row = [case.name, name, found.outcome, f"{len(found.times)}", f"{1e3 * found.median:.2f}", span]
            ratios = [f"{found.median / base:.0f}", f"{1e3 * median(found.walls):.2f}"]
            lines.append("| " + " | ".join([*row, *ratios]) + " |")
            print(lines[-1], flush=True)
    return lines


def grown(seeds: int, limit: float) -> list[str]:
    """How the search over change times grows with n_F and m."""
    lines = [
        "| n_F | m | g1–g10: status, Σ y | median [ms] | with g11: status, Σ y | median [ms] |",
        "|---|---|---|---|---|---|",
    ]
    cells: dict[tuple[int, int], list[str]] = {}
    for n, m, _, case in growing():
        found = measured(case, "segments", by_segments, seeds, limit)
        cells.setdefault((n, m), []).extend([found.outcome, f"{1e3 * found.median:.2f}"])
    lines += [f"| {n} | {m} | " + " | ".join(row) + " |" for (n, m), row in cells.items()]
    print("\n".join(lines), flush=True)
    return lines


def listed(repeats: int) -> list[str]:
    """How long it takes to list every distinct gait of the hexapod."""
    lines = ["| gaits of the hexapod, m = 12 | Σ y | distinct | complete | median [ms] |", "|---|---|---|---|---|"]
    for lost in ((), ("L1",), ("L1", "R1")):
        for gap in (False, True):
            problem, chosen = gait(6, 12, lost), families(gap=gap)
            options = SearchOptions(listing_limit=1000, sample=1000)
            best, times = solve(problem, chosen, options), []
            for _ in range(repeats):
                start = time.process_time()
                found = ties(problem, chosen, best, options)
                times.append(time.process_time() - start)
            name = f"{len(lost)} free, gap rule {'on' if gap and len(lost) > 1 else 'off'}"
            if gap and len(lost) < 2:
                continue  # more than four limbs walk: the rule is not in force
            complete = "yes" if best.changes and found[0].info["ties_complete"] else "no"
            lines.append(f"| {name} | {best.changes} | {len(found)} | {complete} | {1e3 * median(times):.2f} |")
    print("\n".join(lines), flush=True)
    return lines


def versions(missing: Sequence[str]) -> list[str]:
    """What the numbers were made with."""
    known = [f"{name} {metadata.version(name)}" for name in PACKAGES if find_spec(name)]
    found = f"Python {platform.python_version()}, {', '.join(known)}; {platform.machine()}, one thread each."
    if hasattr(os, "getloadavg"):
        found += f" Load of the machine's {os.cpu_count()} cores at the end: {os.getloadavg()[2]:.1f} over 15 minutes."
    return [found, *[f"Skipped, not installed: {name}." for name in missing]]


def page(arguments: argparse.Namespace) -> str:
    """The whole page as Markdown."""
    runs, missing = peers()
    n, limit = arguments.seeds, arguments.limit
    today = datetime.now(UTC).date().isoformat()
    command = f"python -m benchmarks.footfall --seeds {n} --limit {limit:g}"
    tables = _tables(runs, n, limit)
    return "\n".join(
        [
            "# Footfall patterns: speed",
            "",
            f"`{command}`, {today}. " + " ".join(versions(missing)),
            "",
            "Processor time from problem and families to the pattern, building of models included, and the median by "
            "the clock on the wall; each run has its "
            f"own seed and order of the rows, at most {limit:g} s, and no new run begins after {2 * limit:g} s. Every "
            "pattern was checked by every family, outside the clock. *optimal* is proven. All solvers but the "
            "quadratic one get the same rows.",
            "",
            *tables,
            "",
        ]
    )


def _tables(runs: dict[str, Run], n: int, limit: float) -> list[str]:
    return [
        "## Transitions",
        "",
        *compared(transitions(), runs, n, limit),
        "",
        "## Gaits",
        "",
        *compared(gaits(), runs, n, limit),
        "",
        "## Ties",
        "",
        "All distinct gaits, rotations counted once, from the known optimum.",
        "",
        *listed(n),
        "",
        "## Growth",
        "",
        "Transitions from all in stance to all in stance, by the search over change times alone. Feet at ±0.28 m, "
        "spaced 0.12 m (48 limbs: ±0.30 m, 0.10 m), δ = 0.1 m; four and six limbs cannot keep that margin, "
        "which is proven.",
        "",
        *grown(n, limit),
    ]


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, print and write the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--seeds", type=int, default=10, help="runs of each solver on each instance")
    parser.add_argument("--limit", type=float, default=20.0, help="[s] for one run")
    parser.add_argument("--out", type=Path, default=PAGE, help="the page to write")
    chosen = parser.parse_args(arguments)
    text = page(chosen)
    chosen.out.parent.mkdir(parents=True, exist_ok=True)
    chosen.out.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
