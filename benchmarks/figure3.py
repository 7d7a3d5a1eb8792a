"""Figure 3 of the paper: candidates for a hexapod that loses limb 1. ``python -m benchmarks.figure3 [file.png]``

Limbs 1–3 are L1–L3, 4–6 are R1–R3; below each pattern stands what the families and the two rankings say of it.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from gaitforge.footfall.candidates import candidates_without
from gaitforge.footfall.constraints import with_problem_families
from gaitforge.footfall.from_robot import gait_problem
from gaitforge.footfall.given import alternating
from gaitforge.footfall.model import check_pattern
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.footfall.problem import FootfallProblem
from gaitforge.footfall.ranking import Travel, ranked
from gaitforge.report.candidates_plot import candidates_png
from gaitforge.robot.load import load_robot

HERE = Path(__file__).parents[1] / "docs" / "images" / "figure3.png"
COLUMNS = 12


def figure3() -> dict[str, FootfallPattern]:
    """(a) the alternating tripod of a hexapod, and three of the candidates without limb 1."""
    problem = _problem("L1")
    original = alternating(problem.limbs, problem.sides, COLUMNS)
    found = candidates_without(original, "L1")

    def one(*asked: str) -> FootfallPattern:
        return next(p for p in found if asked in [(p.info["operation"], *p.info["limbs"]), *p.info["also"]])

    return {
        "(a) alternating tripod": original,
        "(b) without limb 1": one("original"),
        "(c) 4 and 5 switched": one("switched", "R1", "R2"),
        "(d) 4 and 6 separated": one("separated", "R1", "R3"),
    }


def details(pattern: FootfallPattern) -> str:
    """What the families and the rankings say of a pattern."""
    lost = [n for n in pattern.limbs if n not in pattern.locomotive]
    problem = _problem(*lost)
    nominal = load_robot("hexapod").nominal
    (judged,) = ranked([pattern], problem, Travel(np.array([nominal.speed * nominal.duration / COLUMNS, 0.0])))
    broken = sorted({v.family for v in check_pattern(pattern.contact, problem, with_problem_families(None))})
    verdict = f"breaks {', '.join(broken)}" if broken else "allowed"
    margin = 1000 * judged.info["margin_m"]
    return f"{verdict} · margin {margin:.0f} mm · Σ to centroid {judged.info['centroid_m']:.2f} m"


def _problem(*lost: str) -> FootfallProblem:
    robot = load_robot("hexapod")
    return gait_problem(robot, [n for n in robot.limb_names if n not in lost], COLUMNS)


def main(arguments: list[str]) -> None:
    """Draw the figure into a file."""
    file = Path(arguments[0]) if arguments else HERE
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_bytes(candidates_png([(title, details(p), p) for title, p in figure3().items()]))
    print(file)


if __name__ == "__main__":
    main(sys.argv[1:])
