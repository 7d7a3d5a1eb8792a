"""`MotionOptions`: everything about motion planning that a user may set."""

from __future__ import annotations

from dataclasses import dataclass, field

from gaitforge.motion.costs.body import Body
from gaitforge.motion.costs.posture import Posture
from gaitforge.motion.costs.sharing import Sharing
from gaitforge.motion.costs.smoothness import Smoothness
from gaitforge.motion.family import Family
from gaitforge.motion.solvers.ipopt import Ipopt
from gaitforge.motion.solvers.solution import MotionSolver


@dataclass(frozen=True)
class MotionOptions:
    """Parameters of the motion problem; see conf/motion/default.yaml."""

    samples_per_column: int = 2
    """r; two keep what the samples promise between samples"""
    step_height: float | None = None
    """[m]; None: the robot's own"""
    stability_shares: tuple[float, ...] = (0.5, 0.3)
    """The CoP stays in the support polygon shrunk by this share towards its centroid; tried in this order."""
    progress_share: float = 0.98
    """A transition covers at least this share of the commanded travel."""
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
    ground_tolerance: float = 0.6e-3
    """[m] how deep the spline may push a foot below the ground between samples: stiff limbs answer by
    rocking on few feet and by sliding on many; a finer grid is the remedy"""
    slip_tolerance: float = 3e-3
    """[m] how far the spline may drag a foot in one stance; a finer grid is the remedy"""
    finest: int = 6
    """Most samples a column that refinement may use."""
    stand_seconds: float = 1.0
    """[s] to start from a stand or to stop"""
    refinements: int = 6
    """How often a plan is refined when its spline misses a bound between samples."""
    stability_share: float = 0.5
    """The share in force, one of `stability_shares`."""
    smoothness: Smoothness = field(default_factory=Smoothness)
    posture: Posture = field(default_factory=Posture)
    body: Body = field(default_factory=Body)
    sharing: Sharing = field(default_factory=Sharing)
    swing_weight: float = 100.0
    """per m² s, pull of swinging feet to the smooth height profile"""
    families: tuple[Family, ...] = ()
    """Constraint and cost families beyond the project's own, see docs/motion.md."""
    solver: MotionSolver = field(default_factory=Ipopt)

    def __post_init__(self) -> None:
        for family in self.families:
            if not isinstance(family, Family):
                raise TypeError(f"families: found {type(family).__name__}, expected a constraint or cost family")
