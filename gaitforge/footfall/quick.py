"""The first pattern that will do, for robots that cannot wait: no ties are compared, or few."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitforge.footfall.constraints import Families, with_problem_families
from gaitforge.footfall.from_robot import gait_problem, limbs_named
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.footfall.phases import seam_problems, transition_travel, with_seams
from gaitforge.footfall.placement.place import sectors_of
from gaitforge.footfall.ranking import AMPLE, Travel, judged
from gaitforge.footfall.search import SearchOptions, passes, solve, ties
from gaitforge.footfall.solvers.base import FootfallSolver
from gaitforge.footfall.solvers.segments import Segments

if TYPE_CHECKING:
    from gaitforge.robot.model import RobotModel

LOOKED_AT = 4
"""[patterns] ties of a transition that are compared"""


def pattern_without(
    robot: RobotModel, original: FootfallPattern, lost: Iterable[str], *, constraints: Families | None = None
) -> FootfallPattern | None:
    """The running gait without the limbs that are lost; None when it will not do.

    It has to satisfy every family (g11 needs a placement, so None then) and to keep the centre of mass `AMPLE`
    inside the support polygon with the body shifted once.  InputError for limbs that do not exist.
    """
    gone = limbs_named(robot, lost)
    families = with_problem_families(constraints)
    if not original.cyclic or sectors_of(families) is not None:
        return None
    contact = original.contact.copy()
    contact[[original.limbs.index(name) for name in gone]] = False
    info = {"operation": "original", "limbs": (), "lost": ", ".join(gone)}
    pattern = FootfallPattern(contact, original.limbs, source="candidate", info=info)
    problem = gait_problem(robot, pattern.locomotive, pattern.columns)
    if not passes(contact, problem, families):
        return None
    travel = Travel(np.array([robot.nominal.speed * robot.nominal.duration / pattern.columns, 0.0]))
    _, measured = judged(pattern, problem, travel, "margin")
    return measured if measured.info["margin_m"] >= AMPLE else None


def quick_transition_pattern(
    robot: RobotModel,
    before: Any,
    after: Any,
    *,
    columns: int,
    constraints: Families | None = None,
    seed: int = 0,
    time_limit_s: float = 10.0,
    solver: FootfallSolver | None = None,
) -> FootfallPattern:
    """The best of a few optimal transition patterns; arguments and errors as in `synthesize_transition_pattern`."""
    families = tuple(f for f in with_problem_families(constraints) if f is not sectors_of((f,)))
    few = SearchOptions(solver or Segments(), seed, time_limit_s, listing_limit=LOOKED_AT, sample=LOOKED_AT)
    problem = seam_problems(robot, before, after, columns, None, None, "seam")[0]
    travel = transition_travel(robot, problem, before, after)
    best = solve(problem, families, few)
    found = ties(problem, families, best, few)[:LOOKED_AT]
    return min((judged(with_seams(p, problem), problem, travel, "margin") for p in found), key=lambda item: item[0])[1]
