"""`MotionOptions`: everything about motion planning that a user may set."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TypeVar

from gaitforge.motion.constraints import default_constraints
from gaitforge.motion.costs import default_costs
from gaitforge.motion.family import Family
from gaitforge.motion.solvers.solution import MotionSolver
from gaitforge.motion.solvers.structured import Structured

F = TypeVar("F", bound=Family)


@dataclass(frozen=True)
class MotionOptions:
    """Parameters of the motion problem; see conf/motion/default.yaml."""

    samples_per_column: int = 2
    """r; two keep what the samples promise between samples"""
    step_height: float | None = None
    """[m]; None: the robot's own"""
    stability_shares: tuple[float, ...] = (0.5, 0.3)
    """The CoP stays in the support polygon shrunk by this share towards its centroid; tried in this order."""
    tilt_limit: float = 0.15
    """[rad] roll and pitch"""
    height_range: float = 0.04
    """[m] body height, up and down from the nominal"""
    joint_margin: float = 0.02
    """[rad] kept from joint position limits"""
    clearance: float = 0.004
    """[m] kept between bodies of different limbs"""
    speed_share: float = 0.9
    """Share of a joint's speed limit that the spline may use."""
    effort_share: float = 0.8
    """Share of a joint's effort limit that a cycle of duration *auto* may use (quasi-static torques)."""
    ground_tolerance: float = 0.6e-3
    """[m] how deep the spline may push a foot below the ground between samples: stiff limbs answer by
    rocking on few feet and by sliding on many; a finer grid is the remedy"""
    change_tolerance: float = 0.3e-3
    """[m] the same in a transition between gaits where four feet or fewer ever hold the robot: pushed up by feet
    that land, it rocks over a diagonal, and others lift before it is back"""
    slip_tolerance: float = 3e-3
    """[m] how far the spline may drag a foot in one stance; a finer grid is the remedy"""
    finest: int = 6
    """Most samples a column that refinement may use."""
    stand_seconds: float = 1.0
    """[s] to start from a stand or to stop"""
    refinements: int = 6
    """How often a plan is refined when its spline misses a bound between samples."""
    iterations: int = 500
    """After so many, on a finer grid counted in proportion, a plan is not refined any more; most take 10 to 100"""
    stability_share: float = 0.5
    """The share in force, one of `stability_shares`."""
    constraints: tuple[Family, ...] = field(default_factory=default_constraints)
    """Constraint families, in any order; refinement adds joint speeds and clearances."""
    costs: tuple[Family, ...] = field(default_factory=default_costs)
    """Cost families."""
    explain: bool = True
    """Whether changes that would help are tried when there is no plan: a second or two, for advice that was tested."""
    table: bool = False
    """Whether reports say what the problem consists of (`motion.table`)."""
    solver: MotionSolver = field(default_factory=Structured)

    def __post_init__(self) -> None:
        for key in ("constraints", "costs"):
            for family in getattr(self, key):
                if not isinstance(family, Family):
                    raise TypeError(f"{key}: found {type(family).__name__}, expected a constraint or cost family")

    @property
    def families(self) -> tuple[Family, ...]:
        """All families of the problem."""
        return (*self.constraints, *self.costs)

    def changed(self, kind: type[F], change: Callable[[F], F]) -> MotionOptions:
        """The same options with every family of a kind replaced by `change(family)`."""

        def after(families: tuple[Family, ...]) -> tuple[Family, ...]:
            return tuple(change(f) if isinstance(f, kind) else f for f in families)

        return replace(self, constraints=after(self.constraints), costs=after(self.costs))
