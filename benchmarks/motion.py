"""Motion problems: the structured solver beside IPOPT, hot and cold, where its time goes, growth, random gaits.

``python -m benchmarks.motion [--gaits 50] [--repeats 9] [--out file.md]``

Hot is a problem whose structure has been seen, from segment to plan, started at the nominal guess; cold is a
process with its imports done, from the text of a URDF to a plan.  Processor time leads, since wall-clock time
of a few milliseconds says more about what else the machine does.
"""

from __future__ import annotations

import argparse
import os
import platform
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from statistics import median

import gaitforge as gf
from benchmarks.motion_cases import many_limbs, random_gaits, sized
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.segment import Segment
from gaitforge.motion.solvers.ipopt import Ipopt
from gaitforge.motion.solvers.native import library
from gaitforge.motion.solvers.solution import MotionSolver, Solution
from gaitforge.motion.solvers.structured import Structured

PAGE = Path(__file__).parents[1] / "docs" / "results" / "motion_benchmark.md"
REFERENCE = Ipopt(max_seconds=600.0)
FAST = Structured(fallback=None)
PLAIN = Structured(fallback=None, native=False)
PARTS = ("structure", "evaluate", "factor", "solve", "rest")
PACKAGES = ("casadi", "qdldl", "pin", "numpy", "scipy")


@dataclass(frozen=True)
class Hot:
    """Medians over repeats [ms of processor]."""

    build: float
    solve: float
    unpack: float
    wall: float
    """[ms] by the clock on the wall, building and solving"""
    solution: Solution
    parts: dict[str, float]
    """[ms of processor] of the solve"""

    @property
    def total(self) -> float:
        """[ms of processor]"""
        return self.build + self.solve + self.unpack


def hot(case: Segment, solver: MotionSolver, repeats: int, options: MotionOptions | None = None) -> Hot:
    """From segment to plan, after one solve that nobody times."""
    options = replace(options or MotionOptions(), solver=solver)
    times: list[tuple[float, ...]] = []
    parts: list[Mapping[str, float]] = []
    solution, _ = case.solve(options)
    for _ in range(repeats):
        wall, begin = time.perf_counter(), time.process_time()
        problem, _ = case.build(options)
        built = time.process_time()
        solution = solver.solve(problem)
        solved = time.process_time()
        parts.append(solution.timings)
        elapsed = time.perf_counter() - wall
        whole = time.process_time()
        case.solve(replace(options, solver=_Given(solution)))
        unpacked = time.process_time() - whole - (built - begin)
        times.append((built - begin, solved - built, max(0.0, unpacked), elapsed))
    build, solve, unpack, wall = (1e3 * median(column) for column in zip(*times, strict=True))
    middle = {part: 1e3 * median(run[part] for run in parts) for part in solution.timings}
    return Hot(build, solve, unpack, wall, solution, middle)


@dataclass(frozen=True)
class _Given:
    """A solver that knows the answer: what is left is building and unpacking."""

    solution: Solution

    def solve(self, problem: object, start: object = None) -> Solution:
        return self.solution


def table(head: Sequence[str], rows: Sequence[Sequence[object]]) -> list[str]:
    """Markdown."""
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    return lines + ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]


def compared(repeats: int) -> list[str]:
    """Hot problems of the issue's sizes."""
    hexapod, dodecapod = gf.load_robot("hexapod"), gf.load_robot("dodecapod")
    cases = {
        "hexapod, 18 joints × 12 samples": sized(hexapod, 12),
        "hexapod, 18 × 20": sized(hexapod, 20),
        "dodecapod, 36 × 20": sized(dodecapod, 20),
    }
    rows, shares = [], []
    for name, case in cases.items():
        print(name, flush=True)
        reference = hot(case, REFERENCE, max(3, repeats // 3))
        fast, plain = hot(case, FAST, repeats), hot(case, PLAIN, repeats)
        off = fast.solution.cost / reference.solution.cost - 1
        rows.append(
            [
                name,
                f"{reference.total:.0f} ({reference.solution.iterations})",
                f"**{fast.total:.1f}** ({fast.solution.iterations})",
                f"{plain.total:.1f}",
                f"{reference.total / fast.total:.1f}",
                f"{off:.0e}",
                f"{fast.solution.residual:.0e}",
                f"{fast.wall:.0f}",
            ]
        )
        own = [f"{fast.parts[p]:.1f}" for p in PARTS]
        shares.append([name, f"{fast.build:.1f}", *own, f"{fast.unpack:.1f}"])
    head = ["", "IPOPT ms (iterations)", "structured ms (iterations)", "… without a compiler", "ratio"]
    head += ["cost against IPOPT", "largest violation", "structured, wall ms without unpacking"]
    text = [*table(head, rows), "", "Where the structured solver's time goes [ms]:", ""]
    return text + table(["", "build", *PARTS, "unpack"], shares)


COLD = """
import sys, time
import casadi, pinocchio, qdldl, scipy.interpolate, scipy.optimize, scipy.sparse, yourdfpy
import gaitforge as gf
from benchmarks.motion_cases import segment
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.solvers.{module} import {name}
from gaitforge.footfall.pattern import FootfallPattern
import numpy as np
contact = np.array([[int(c) for c in row] for row in sys.argv[2].split(",")], dtype=bool)
begin, wall = time.process_time(), time.perf_counter()
robot = gf.load_robot(sys.argv[1])
loaded = time.process_time()
pattern = FootfallPattern(contact, robot.limb_names, True)
solution, plan = segment(robot, pattern).solve(MotionOptions(solver={name}()))
print(loaded - begin, time.process_time() - begin, time.perf_counter() - wall, solution.solved)
"""


def cold(repeats: int) -> list[str]:
    """Processes of their own, from a URDF to a plan."""
    rows = []
    for limbs, samples in ((6, 12), (12, 20)):
        print("cold", limbs, flush=True)
        with tempfile.TemporaryDirectory() as folder:
            robot = many_limbs(limbs, Path(folder) / "robot")
            pattern = gf.synthesize_gait_pattern(robot, columns=samples // 2)
            text = ",".join("".join(str(int(c)) for c in row) for row in pattern.contact)
            row = [f"{limbs} limbs, {3 * limbs} joints × {samples} samples"]
            urdf = Path(folder) / "robot.urdf"
            urdf.write_text(robot.urdf, encoding="utf-8")
            for module, solver in (("ipopt", "Ipopt"), ("structured", "Structured")):
                program = COLD.format(module=module, name=solver)
                runs = [_run(program, str(urdf), text) for _ in range(repeats)]
                load, total, wall = (median(run[k] for run in runs) for k in range(3))
                row.append(f"{total:.2f} (robot {load:.2f}; wall {wall:.2f})")
        rows.append(row)
    return table(["", "IPOPT s", "structured s"], rows)


def _run(program: str, *arguments: str) -> tuple[float, float, float]:
    root = str(Path(__file__).parents[1])
    out = subprocess.run(
        [sys.executable, "-c", program, *arguments], capture_output=True, text=True, check=True, cwd=root
    )
    load, total, wall, solved = out.stdout.split()
    if solved != "True":
        raise RuntimeError(f"no plan: {out.stdout}{out.stderr}")
    return float(load), float(total), float(wall)


def grown(repeats: int) -> list[str]:
    """More limbs at 18 samples, more samples on twelve limbs."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        robots = {n: many_limbs(n, Path(folder) / str(n)) for n in (12, 24, 36, 48)}
        cases = [(n, 18, sized(robot, 18)) for n, robot in robots.items()]
        cases += [(12, samples, sized(robots[12], samples)) for samples in (36, 60, 100)]
        for limbs, samples, case in cases:
            print(limbs, samples, flush=True)
            fast = hot(case, FAST, max(3, repeats // 3))
            status = "" if fast.solution.solved else f" {fast.solution.status}"
            iterations = f"{fast.solution.iterations}{status}"
            own = [f"{fast.parts[p]:.0f}" for p in ("evaluate", "factor")]
            per = fast.solve / max(1, fast.solution.iterations)
            rows.append([limbs, samples, len(fast.solution.x), f"{fast.total:.0f}", iterations, f"{per:.1f}", *own])
    head = ["limbs", "samples", "variables", "ms", "iterations", "ms an iteration", "of it evaluating", "factoring"]
    return table(head, rows)


def lots(count: int) -> list[str]:
    """Random gaits: iterations, and whether anything that IPOPT solves is lost."""
    rows, lost, ours, theirs, ratios, worse = [], 0, [], [], [], 0.0
    for number, gait in enumerate(random_gaits(count, seed=0), start=1):
        for share in MotionOptions().stability_shares:
            problem, _ = gait.segment.build(replace(MotionOptions(), stability_share=share))
            begin = time.process_time()
            reference = REFERENCE.solve(problem)
            took = time.process_time() - begin
            if reference.solved:
                break
        FAST.solve(problem)
        begin = time.process_time()
        fast = FAST.solve(problem)
        ratio = took / (time.process_time() - begin)
        print(number, gait.robot, gait.pattern, reference.status, fast.status, fast.iterations, flush=True)
        if not reference.solved and not fast.solved:
            continue
        lost += reference.solved and not fast.solved
        ours.append(fast.iterations)
        off = fast.cost / reference.cost - 1 if reference.solved else float("nan")
        theirs.append(reference.iterations)
        ratios.append(ratio)
        worse = max(worse, off)
        turn = f"{gait.command.speed:.3f}, {gait.command.heading:.2f}, {gait.command.yaw_rate:.2f}"
        cells = [number, f"{gait.robot}, {gait.limbs} limbs", gait.pattern, turn, reference.iterations]
        rows.append([*cells, fast.iterations if fast.solved else fast.status, f"{off:.0e}", f"{ratio:.0f}"])
    text = [
        f"{len(rows)} of {count} random gaits can be solved by either. Iterations: median **{median(ours):.0f}** "
        f"(from {min(ours)} to {max(ours)}), IPOPT {median(theirs):.0f}. Solved by IPOPT and lost: **{lost}**. "
        f"Largest cost above IPOPT's: {worse:.0e}. Processor time: {median(ratios):.0f} times less (median).",
        "",
    ]
    head = ["", "robot", "pattern", "m/s, rad, rad/s", "IPOPT", "structured", "cost against IPOPT", "time ratio"]
    return text + table(head, rows)


def versions() -> list[str]:
    """What was measured, on what."""
    known = [f"{name} {metadata.version(name)}" for name in PACKAGES]
    compiler = "with compiled code" if library("ldl.c") else "without a C compiler"
    text = f"Python {platform.python_version()}, {', '.join(known)}; {platform.machine()}, one thread, {compiler}."
    if hasattr(os, "getloadavg"):
        text += f" Load of the machine's {os.cpu_count()} cores: {os.getloadavg()[2]:.1f} over 15 minutes."
    return [text]


def page(repeats: int, count: int) -> str:
    """The whole page."""
    sections: dict[str, Callable[[], list[str]]] = {
        "Hot": lambda: compared(repeats),
        "Cold": lambda: cold(max(3, repeats // 3)),
        "Growth": lambda: grown(repeats),
        f"{count} random gaits": lambda: lots(count),
    }
    lines = [
        "# Motion benchmark",
        "",
        f"{datetime.now(UTC):%Y-%m-%d}, `python -m benchmarks.motion --repeats {repeats} --gaits {count}`; times are "
        "processor time, medians.",
        "",
    ]
    for title, section in sections.items():
        lines += [f"## {title}", "", *_notes(title), *section(), ""]
    return "\n".join([*lines[:4], *versions(), "", *lines[4:]])


def _notes(title: str) -> list[str]:
    notes = {
        "Hot": "From segment to plan: building the problem, solving it from the nominal guess, unpacking the plan. The "
        "structure (pattern, ordering, buffers) has been seen. IPOPT's time includes building CasADi's functions.",
        "Cold": "A process with its imports done, from the text of a URDF to a plan; what is compiled "
        "was compiled before. Robots without tools, so that nothing has to be said about them beside the URDF.",
        "Growth": "Legs of the dodecapod on longer bodies; two samples a column.",
    }
    return [notes[title], ""] if title in notes else []


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=9, help="of every hot measurement")
    parser.add_argument("--gaits", type=int, default=50, help="random gaits")
    parser.add_argument("--out", type=Path, default=PAGE, help="where the page goes")
    given = parser.parse_args(arguments)
    text = page(given.repeats, given.gaits)
    given.out.write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
