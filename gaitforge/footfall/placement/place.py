"""Placement before g11: footholds and a shift of the body with which the centre of mass is well inside."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gaitforge.errors import InfeasibleFootfall, UnsolvedError
from gaitforge.footfall.constraints import ConstraintSet, SupportSectors
from gaitforge.footfall.model import build_program
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.footfall.placement.reach import Reach, reach_of
from gaitforge.footfall.placement.spread import Cases, Stance, centers_of, margin_of, spread, worst_margin
from gaitforge.footfall.problem import FootfallProblem
from gaitforge.footfall.search import SearchOptions, solve, ties
from gaitforge.footfall.solvers.segments import Segments

if TYPE_CHECKING:
    from gaitforge.robot.model import RobotModel

Array = NDArray[np.float64]

AMPLE = 0.05
"""[m] margin beyond which no more is looked for"""
FAINT = 1e-3
"""[m] smallest margin that counts as one"""
FINE = 2e-3
"""[m] steps in which margins are tried"""
SHIFTS = (0.0, 0.03, -0.03, 0.06, -0.06)
"""[m] by which the body is moved ahead at first, the feet staying"""
ROUNDS = 4
GRAIN = 1e-4
"""[m] margins closer than this are alike"""
TRIED = 8
"""Patterns without g11 that are tried where none has a margin over a body that stays"""


@dataclass(frozen=True, eq=False)
class Placement:
    """Footholds and centre of mass in the base frame, and what they are good for."""

    footholds: Array
    """(n_F, 2) [m]"""
    center_of_mass: Array
    """(2,) exact, of the posture that stands on them [m]"""
    body_shift: Array
    """(2,) how far the body is from its place over the feet in the nominal stance [m]"""
    margin: float
    """[m] worst margin of the pattern it was made for"""
    posture: dict[str, list[float]]
    """limb that walks → its joints [rad] in that posture"""
    path: Array | None = None
    """(m + 1, 2) centre of mass at t_j over a body that sways [m]; None where it stays"""

    def on(self, problem: FootfallProblem) -> FootfallProblem:
        """The problem with these footholds."""
        return replace(problem, footholds=self.footholds, center_of_mass=self.center_of_mass)


def sectors_of(families: Sequence[ConstraintSet]) -> SupportSectors | None:
    """The family g11 among others, if it is there."""
    return next((f for f in families if isinstance(f, SupportSectors)), None)


def with_margin(families: Sequence[ConstraintSet], delta: float) -> tuple[ConstraintSet, ...]:
    """The families with another δ [m] in g11."""
    return tuple(replace(f, delta=delta) if isinstance(f, SupportSectors) else f for f in families)


def place(
    robot: RobotModel, problem: FootfallProblem, families: Sequence[ConstraintSet], options: SearchOptions
) -> Placement | None:
    """Footholds and body shift that make the worst margin over the columns of some pattern as large as was found.

    In turns: the pattern with the largest δ for which the program has one, over the footholds so far; then the
    footholds with the largest margin for that pattern.  Ends at `AMPLE`.  A local optimum, begun from the
    best of a few shifts of the body.  None when no shift gives any pattern a margin.
    """
    reach = reach_of(robot, problem)
    offsets, margin, contact = _begin(reach, problem, families, options)
    if contact is None:
        return _still_for_some_tie(reach, problem, families, options)
    for _ in range(ROUNDS):
        stance, margin = spread(reach, Cases.still(contact), offsets, AMPLE)
        offsets = stance.offsets
        above, better = _best_pattern(reach, problem, families, options, offsets, margin)
        if better is None:
            break
        margin, contact = above, better
    return _settled(reach, Cases.still(contact), Stance(offsets, np.zeros((1, 2))))


def _still_for_some_tie(
    reach: Reach, problem: FootfallProblem, families: Sequence[ConstraintSet], options: SearchOptions
) -> Placement | None:
    """The placement with the largest margin over a body that stays, for patterns found without g11."""
    try:
        _, tried = _without_g11(problem, families, options)
    except (InfeasibleFootfall, UnsolvedError):
        return None
    found = []
    for pattern in tried:
        cases = Cases.still(pattern.contact)
        placement = _settled(reach, cases, spread(reach, cases, np.zeros_like(reach.footholds), AMPLE)[0])
        if placement is not None:
            found.append(placement)
        if placement is not None and placement.margin >= AMPLE - GRAIN:
            break
    best = max(found, key=lambda p: round(p.margin / GRAIN), default=None)
    return best if best is not None and best.margin > FAINT else None


def _without_g11(
    problem: FootfallProblem, families: Sequence[ConstraintSet], options: SearchOptions
) -> tuple[tuple[ConstraintSet, ...], list[FootfallPattern]]:
    """The other families, and some of the patterns that are best by them, spread over the ties."""
    rest = tuple(f for f in families if not isinstance(f, SupportSectors))
    every = ties(problem, rest, solve(problem, rest, options), options)
    spaced = np.unique(np.linspace(0, len(every) - 1, min(len(every), TRIED)).astype(int))
    return rest, [every[k] for k in spaced]


def place_swaying(robot: RobotModel, problem: FootfallProblem, pattern: FootfallPattern) -> Placement | None:
    """Footholds and places of the body, one at each change of contact, with the worst margin as large as was found.

    Needed where no single point lies inside every support polygon: with four walking limbs, one swinging at a
    time, the four triangles share but the crossing of the diagonals.
    """
    reach = reach_of(robot, problem)
    contact, m = pattern.contact, pattern.columns
    changes = [j for j in range(m) if (contact[:, j] != contact[:, j - 1]).any() and (pattern.cyclic or j > 0)]
    times = changes if pattern.cyclic else [0, *changes, m]
    if not times:
        return None
    cases = Cases.swaying(contact, times, pattern.cyclic)
    stance, _ = spread(reach, cases, np.zeros_like(reach.footholds), AMPLE)
    return _settled(reach, cases, stance, times, m if pattern.cyclic else None)


@dataclass(frozen=True, eq=False)
class Prepared:
    """A gait problem over placed footholds, and the families with which its patterns are looked for."""

    robot: RobotModel
    problem: FootfallProblem
    families: tuple[ConstraintSet, ...]
    """g11 has the δ that holds; it is left out where the body has to sway"""
    asked: SupportSectors | None
    """g11 as the user asked for it; None where it is not among the families"""
    placement: Placement | None = None

    def finish(self, patterns: Iterable[FootfallPattern]) -> list[FootfallPattern]:
        """The patterns with their margin, δ and placement in `info`; of a swaying body those with a margin alone."""
        if self.asked is None:
            return list(patterns)
        if self.placement is not None:
            delta = next(f.delta for f in self.families if isinstance(f, SupportSectors))
            return [_reported(p, self.problem, self.placement, self.asked.delta, delta) for p in patterns]
        swaying = [swayed(self.robot, p, self.problem, self.asked) for p in patterns]
        return [p for p in swaying if p.info["delta_m"] is not None]


def prepared(
    robot: RobotModel, problem: FootfallProblem, families: Sequence[ConstraintSet], options: SearchOptions
) -> Prepared:
    """The problem over placed footholds and the families with the largest δ of g11 that has a pattern there.

    Without g11 among the families both are as they were.
    """
    g11, families = sectors_of(families), tuple(families)
    if g11 is None:
        return Prepared(robot, problem, families, None)
    placement = place(robot, problem, families, options)
    if placement is not None:
        there = placement.on(problem)
        for delta in (d for d in g11.margins if d <= placement.margin):
            chosen = with_margin(families, delta)
            if _any_pattern(there, chosen, options) is not None:
                return Prepared(robot, there, chosen, g11, placement)
    return Prepared(robot, problem, tuple(f for f in families if f is not g11), g11)


def placed_pattern(
    robot: RobotModel, problem: FootfallProblem, families: Sequence[ConstraintSet], options: SearchOptions
) -> FootfallPattern:
    """A pattern with the least Σ y over placed footholds; of a swaying body the tie with the largest margin.

    δ of g11 is the largest of its margins that holds; a smaller one than asked for stands in `relaxed`.
    `info` gets delta_m, support_margin_m, body_shift_m, footholds_m, center_of_mass_m and posture_rad (limb →
    joints) or, where the body sways, sway_m.  Raises InfeasibleFootfall (of g1–g10 where these clash already,
    else naming g11) and UnsolvedError.
    """
    ready = prepared(robot, problem, families, options)
    if ready.placement is not None or ready.asked is None:
        return ready.finish([solve(ready.problem, ready.families, options)])[0]
    _, tried = _without_g11(problem, families, options)  # raises where g11 is not to blame
    found = ready.finish(tried)
    if not found:
        raise no_margin(problem, families, options)
    return max(found, key=lambda p: round(p.info["support_margin_m"] / GRAIN))


def no_margin(problem: FootfallProblem, families: Sequence[ConstraintSet], options: SearchOptions) -> Exception:
    """What to raise when no footholds give a pattern a margin: a proof for the nominal ones, else *unsolved*."""
    g11 = sectors_of(families)
    try:
        solve(problem, families if g11 is None else with_margin(families, g11.margins[-1]), options)
    except InfeasibleFootfall as error:
        return error
    return UnsolvedError("no footholds within reach were found that give a pattern the margin g11 asks for")


def swayed(
    robot: RobotModel, pattern: FootfallPattern, problem: FootfallProblem, g11: SupportSectors
) -> FootfallPattern:
    """The pattern with the margin that a swaying body has over it; delta_m is None where that is below all of g11's."""
    placement = place_swaying(robot, problem, pattern)
    if placement is None:
        return replace(pattern, info={**pattern.info, "delta_m": None, "support_margin_m": None})
    delta = next((d for d in g11.margins if d <= placement.margin), None)
    return _reported(pattern, placement.on(problem), placement, g11.delta, delta)


def _reported(
    pattern: FootfallPattern, problem: FootfallProblem, placement: Placement, asked: float, delta: float | None
) -> FootfallPattern:
    assert problem.footholds is not None
    margin = placement.margin
    if placement.path is None:
        margin = worst_margin(np.unique(pattern.contact.T, axis=0), problem.footholds, problem.center_of_mass)
    info = {
        **pattern.info,
        "delta_m": delta,
        "support_margin_m": margin,
        "body_shift_m": placement.body_shift.tolist(),
        "footholds_m": problem.footholds.tolist(),
        "center_of_mass_m": problem.center_of_mass.tolist(),
    }
    notes = []
    if delta is None or delta < asked:
        held = margin if delta is None else delta
        notes.append(f"g11: margin of {1000 * held:.3g} mm instead of {1000 * asked:g} mm")
    if placement.path is None:
        info["posture_rad"] = placement.posture
    else:
        info["sway_m"] = placement.path.tolist()
        sway = 1000 * float(np.ptp(placement.path, axis=0).max())
        notes.append(f"g11: the body sways by {sway:.0f} mm instead of staying over one point")
    return replace(pattern, info=info, relaxed=(*pattern.relaxed, *notes))


def _begin(
    reach: Reach, problem: FootfallProblem, families: Sequence[ConstraintSet], options: SearchOptions
) -> tuple[Array, float, NDArray[np.bool_] | None]:
    """The shift of the body, as far as the feet can follow, with the largest margin, and a pattern with it."""
    none = np.zeros_like(reach.footholds)
    best: tuple[Array, float, NDArray[np.bool_] | None] = none, 0.0, None
    for shift in SHIFTS:
        offsets = _shifted(reach, shift)
        margin, contact = _best_pattern(reach, problem, families, options, offsets, best[1])
        if contact is not None:
            best = offsets, margin, contact
        if best[1] >= AMPLE:
            break
    return best


def _shifted(reach: Reach, shift: float) -> Array:
    """Offsets of the feet for a body that much ahead [m], as far as reach and neighbours let them follow."""
    offsets = np.zeros_like(reach.footholds)
    for part in (1.0, 0.75, 0.5, 0.25):
        for i in reach.walking:
            offsets[i] = _within(reach, i, np.array([-part * shift, 0.0]))
        ahead = (reach.footholds + offsets)[:, 0]
        if all(ahead[a] - ahead[b] >= least - GRAIN for a, b, least in reach.neighbours):
            return offsets
    return np.zeros_like(reach.footholds)


def _within(reach: Reach, limb: int, offset: Array) -> Array:
    """The part of an offset that the foot can reach."""
    along = reach.normals[limb] @ offset
    with np.errstate(divide="ignore", invalid="ignore"):
        parts = np.where(along > 1e-12, reach.extents[limb] / along, np.inf)
    return np.asarray(offset * min(1.0, float(parts.min())))


def _best_pattern(
    reach: Reach,
    problem: FootfallProblem,
    families: Sequence[ConstraintSet],
    options: SearchOptions,
    offsets: Array,
    above: float,
) -> tuple[float, NDArray[np.bool_] | None]:
    """The largest margin above a given one for which there is a pattern over these footholds; None if there is none."""
    feet = reach.footholds + offsets
    center = centers_of(reach, Stance(offsets, np.zeros((1, 2))))[0]
    there = replace(problem, footholds=feet, center_of_mass=center)
    low, high = max(above, FAINT - FINE), AMPLE
    found: NDArray[np.bool_] | None = None
    delta = low + FINE
    while delta <= high:
        contact = _any_pattern(there, with_margin(families, delta), options)
        if contact is None:
            high = delta - FINE
        else:
            reached = worst_margin(np.unique(contact.T, axis=0), feet, center)
            low, found = max(delta, min(reached, AMPLE)), contact
        if high - low < FINE:
            break
        delta = (low + high) / 2 if found is not None else delta + 2 * AMPLE
    return low, found


def _any_pattern(
    problem: FootfallProblem, families: Sequence[ConstraintSet], options: SearchOptions
) -> NDArray[np.bool_] | None:
    """Some pattern that satisfies the families, without an explanation when there is none."""
    if isinstance(options.solver, Segments):
        solution, _ = options.solver.search(problem, families)
        if solution.contact is not None or solution.status == "infeasible":
            return solution.contact
    return options.solver.minimize(build_program(problem, families), options.time_limit_s, options.seed).contact


def _settled(
    reach: Reach, cases: Cases, stance: Stance, times: Sequence[int] = (), period: int | None = None
) -> Placement | None:
    """The placement with its exact centre of mass, drawn back towards the nominal stance until it is in reach."""
    for part in (1.0, 0.9, 0.7, 0.4, 0.0):
        offsets, shifts = part * stance.offsets, part * stance.shifts
        joints = reach.posture(offsets)
        if joints is None:
            continue
        still = reach.center_of_mass_of(joints)
        here = [reach.center_of_mass_at(offsets - shift) if shift.any() else still for shift in shifts]
        centers = np.array([c + s for c, s in zip(here, shifts, strict=True) if c is not None])
        if len(centers) < len(shifts):
            continue
        feet = reach.footholds + offsets
        path = _path(times, centers, period) if len(times) else None
        shift = -offsets[list(reach.walking)].mean(axis=0)
        return Placement(feet, still, shift, margin_of(cases, feet, centers), _by_limb(reach, joints), path)
    return None


def _by_limb(reach: Reach, joints: Array) -> dict[str, list[float]]:
    limbs = [reach.robot.limbs[i] for i in reach.walking]
    return {limb.name: joints[reach.robot.joint_indices(limb)].tolist() for limb in limbs}


def _path(times: Sequence[int], centers: Array, period: int | None) -> Array:
    """(m + 1, 2) the centre at t_0 … t_m, on straight lines between the places."""
    last = times[-1] if period is None else period
    return np.stack([np.interp(np.arange(last + 1), times, axis, period=period) for axis in centers.T], axis=1)
