"""Which limbs a robot can lose: a pattern or a proof for every subset, by g1–g10, and with placement and g11.

    OMP_NUM_THREADS=1 python -m benchmarks.lost_limbs

writes docs/results/lost_limbs.md; needs shapely, which checks the margins.
"""

from __future__ import annotations

import datetime
import platform
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from itertools import combinations
from pathlib import Path

import numpy as np

from gaitforge.errors import InfeasibleFootfall
from gaitforge.footfall.constraints import ConstraintSet, SupportSectors, with_problem_families
from gaitforge.footfall.from_robot import gait_problem
from gaitforge.footfall.model import check_pattern
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.footfall.placement.place import placed_pattern
from gaitforge.footfall.search import SearchOptions, solve
from gaitforge.robot.load import load_robot
from gaitforge.robot.model import RobotModel

PAGE = Path(__file__).parents[1] / "docs" / "results" / "lost_limbs.md"
ROBOTS = (("hexapod", 3), ("dodecapod", 4))
"""Robot and the most limbs that it loses"""
COLUMNS = 12
SLACK = 1e-6
"""[m] by which shapely's margin may differ from the reported one"""


@dataclass(frozen=True)
class Case:
    """What was found for one subset of lost limbs."""

    lost: tuple[str, ...]
    changes: int | None
    clash: tuple[str, ...]
    seconds: float
    margin: float | None = None
    """[m] reported"""
    delta: float | None = None
    """[m] of g11 that held"""
    sways: bool = False


def subsets(robot: RobotModel, most: int) -> Iterator[tuple[str, ...]]:
    """Every set of one to `most` limbs."""
    for size in range(1, most + 1):
        yield from combinations(robot.limb_names, size)


def by_families(robot: RobotModel, lost: Sequence[str], families: Sequence[ConstraintSet]) -> Case:
    """A pattern or a proof without any geometry; a pattern is checked by every family."""
    problem = gait_problem(robot, [n for n in robot.limb_names if n not in lost], COLUMNS)
    start = time.process_time()
    try:
        pattern = solve(problem, families, SearchOptions())
    except InfeasibleFootfall as error:
        return Case(tuple(lost), None, tuple(error.explain["families"]), time.process_time() - start)
    seconds = time.process_time() - start
    if check_pattern(pattern.contact, problem, families):
        raise AssertionError(f"{robot.name} without {lost}: the pattern breaks a family")
    return Case(tuple(lost), pattern.changes, (), seconds)


def with_placement(robot: RobotModel, lost: Sequence[str], families: Sequence[ConstraintSet]) -> Case:
    """A pattern over placed footholds, its margin confirmed by shapely, or a proof."""
    problem = gait_problem(robot, [n for n in robot.limb_names if n not in lost], COLUMNS)
    start = time.process_time()
    try:
        pattern = placed_pattern(robot, problem, families, SearchOptions())
    except InfeasibleFootfall as error:
        return Case(tuple(lost), None, tuple(error.explain.get("families", ["g11"])), time.process_time() - start)
    seconds, info = time.process_time() - start, pattern.info
    measured = shapely_margin(pattern)
    if abs(measured - info["support_margin_m"]) > SLACK or measured < info["delta_m"] - SLACK:
        raise AssertionError(f"{robot.name} without {lost}: shapely measures {measured} m, reported {dict(info)}")
    return Case(tuple(lost), pattern.changes, (), seconds, measured, info["delta_m"], "sway_m" in info)


def shapely_margin(pattern: FootfallPattern) -> float:
    """[m] least distance of the centre of mass from the edge of the support polygon, at both ends of every column."""
    from shapely.geometry import MultiPoint, Point

    feet, m = np.array(pattern.info["footholds_m"]), pattern.columns
    path = np.array(pattern.info.get("sway_m", [pattern.info["center_of_mass_m"]] * (m + 1)))
    worst = np.inf
    for j, stance in enumerate(pattern.contact.T):
        polygon = MultiPoint([tuple(f) for f in feet[stance]]).convex_hull
        for place in path[j : j + 2]:
            point = Point(*place)
            distance = polygon.exterior.distance(point)
            worst = min(worst, distance if polygon.covers(point) else -distance)
    return float(worst)


def main() -> None:
    """Solve every subset and write the page."""
    default = with_problem_families(None)
    paper = tuple(f for f in default if f.key != "gap")
    plain: dict[str, list[Case]] = {}
    placed: dict[str, list[Case]] = {}
    robots = {name: load_robot(name) for name, _ in ROBOTS}
    start = time.process_time()
    for name, most in ROBOTS:
        plain[name] = [by_families(robots[name], lost, paper) for lost in subsets(robots[name], most)]
    middle = time.process_time()
    for name, most in ROBOTS:
        placed[name] = [
            with_placement(robots[name], lost, (*default, SupportSectors())) for lost in subsets(robots[name], most)
        ]
    end = time.process_time()
    PAGE.parent.mkdir(parents=True, exist_ok=True)
    PAGE.write_text(_page(plain, placed, middle - start, end - middle), encoding="utf-8")
    print(PAGE)


def _page(plain: dict[str, list[Case]], placed: dict[str, list[Case]], first: float, second: float) -> str:
    today = datetime.date.today().isoformat()
    versions = ", ".join(f"{p} {version(p)}" for p in ("numpy", "scipy", "ortools", "shapely"))
    lines = [
        "# Lost limbs",
        "",
        "`OMP_NUM_THREADS=1 python -m benchmarks.lost_limbs`, "
        f"{today}, Python {platform.python_version()}, {versions}; {platform.machine()}, one process; "
        "seconds of processor time.",
        "",
        f"Every set of lost limbs, {COLUMNS} columns: a cyclic pattern that passes every family's own check, "
        "or a proof that there is none.",
        "",
        f"## By g1–g10: {first:.1f} s in all",
        "",
        "| robot | lost | subsets | patterns | proofs | Σ y of the patterns | clashes | median, worst |",
        "|---|---|---|---|---|---|---|---|",
        *_plain_rows(plain),
        "",
        f"## With placement and g11: {second:.1f} s in all",
        "",
        f"Default families (the gap rule while four or fewer limbs walk) and g11 with δ = "
        f"{1000 * SupportSectors().delta:g} mm, then {_millimetres(SupportSectors().fallback)}. Footholds within "
        "reach, the exact centre of mass of the posture that stands on them; every margin confirmed by shapely "
        "at both ends of every column. Where no one point lies in all support polygons, the body sways: it has a "
        "place of its own at each change of contact.",
        "",
        "| robot | lost | patterns | proofs | δ held | body sways | margin: least, median [mm] | median, worst |",
        "|---|---|---|---|---|---|---|---|",
        *_placed_rows(placed),
        "",
        "## Hexapod, each pattern",
        "",
        "| lost | Σ y | δ held [mm] | margin [mm] | body sways |",
        "|---|---|---|---|---|",
        *_each(placed["hexapod"]),
        "",
    ]
    return "\n".join(lines)


def _plain_rows(found: dict[str, list[Case]]) -> Iterator[str]:
    for name, cases in found.items():
        for size, group in _by_size(cases):
            patterns = [c for c in group if c.changes is not None]
            clashes = Counter(" + ".join(c.clash) for c in group if c.changes is None)
            changes = Counter(c.changes for c in patterns)
            yield _row(
                name,
                size,
                len(group),
                len(patterns),
                len(group) - len(patterns),
                ", ".join(f"{n} × {y}" for y, n in sorted(changes.items(), key=str)) or "–",
                ", ".join(f"{n} × {{{c}}}" for c, n in sorted(clashes.items())) or "–",
                _times(group),
            )
        yield _row(f"**{name}**", "all", len(cases), *_split(cases), "", "", _times(cases))


def _placed_rows(found: dict[str, list[Case]]) -> Iterator[str]:
    for name, cases in found.items():
        for size, group in _by_size(cases):
            yield _row(name, size, *_split(group), *_margins(group), _times(group))
        yield _row(f"**{name}**", "all", *_split(cases), *_margins(cases), _times(cases))


def _margins(cases: Sequence[Case]) -> tuple[str, str, str]:
    margins = [1000 * c.margin for c in cases if c.margin is not None]
    deltas = Counter(f"{1000 * c.delta:g} mm" for c in cases if c.delta is not None)
    held = ", ".join(f"{n} × {d}" for d, n in sorted(deltas.items(), key=lambda i: -float(i[0].split()[0])))
    least = f"{min(margins):.1f}, {np.median(margins):.1f}" if margins else "–"
    return held or "–", str(sum(c.sways for c in cases)), least


def _each(cases: Sequence[Case]) -> Iterator[str]:
    for c in cases:
        if c.margin is not None and c.delta is not None:
            sways = "yes" if c.sways else "no"
            yield _row(", ".join(c.lost), c.changes, f"{1000 * c.delta:g}", f"{1000 * c.margin:.1f}", sways)


def _split(cases: Sequence[Case]) -> tuple[int, int]:
    patterns = sum(c.changes is not None for c in cases)
    return patterns, len(cases) - patterns


def _by_size(cases: Sequence[Case]) -> Iterator[tuple[int, list[Case]]]:
    for size in sorted({len(c.lost) for c in cases}):
        yield size, [c for c in cases if len(c.lost) == size]


def _times(cases: Sequence[Case]) -> str:
    seconds = [1000 * c.seconds for c in cases]
    return f"{np.median(seconds):.1f} ms, {max(seconds):.0f} ms"


def _millimetres(lengths: Sequence[float]) -> str:
    return " and ".join(f"{1000 * length:g} mm" for length in lengths)


def _row(*cells: object) -> str:
    return "| " + " | ".join(str(c) for c in cells) + " |"


if __name__ == "__main__":
    main()
