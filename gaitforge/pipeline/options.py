"""How much a run may try, and the tools that it works with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from gaitforge.motion.options import MotionOptions
    from gaitforge.pipeline.search.refusals import Refusal
    from gaitforge.record.recorder import McapRecorder
    from gaitforge.verify.both import Both
    from gaitforge.verify.checks import CheckLimits
    from gaitforge.verify.simulator import Simulator


@dataclass(frozen=True)
class Search:
    """How far the cascade goes before a search is called unsolved."""

    gait_candidates: int = 6
    """Footfall patterns tried for a gait."""
    transition_candidates: int = 4
    """Footfall patterns tried for each pair of columns and column time of a transition."""
    transition_columns: tuple[int, ...] = (0, 1, -1, 2)
    """Columns added to the robot's nominal number, tried in this order."""
    transition_stretch: tuple[float, ...] = (1.0, 1.333)
    """Factors on the robot's nominal column time, tried in this order."""
    transition_slack: int = 1
    """Change times more than the fewest that a transition may have, for margin."""
    transition_phases: Literal["seam", "paper", "best"] = "seam"
    """Columns of the gaits that a transition begins and ends with (`footfall.phases.Phases`); with *best* the gaits
    are begun where they meet, and a gait between two transitions is left where it was entered."""
    gait_batch: int = 2
    """Patterns of a gait that are planned before the cheapest of them is taken."""
    transition_batch: int = 1
    """Tries at a transition that are made before the cheapest of them is taken."""
    limp_friction: float = 0.2
    """[N m] dry friction in the joints of limp limbs that plans count on"""
    replans: int = 2
    """Times that a task is planned again without the segments that fail in simulation."""
    workers: int = 1
    """Processes that plan at the same time, this one included; results do not depend on it."""

    def __post_init__(self) -> None:
        if self.gait_candidates < 1 or self.transition_candidates < 1:
            raise ValueError("at least one candidate")
        if min(self.gait_batch, self.transition_batch, self.workers) < 1:
            raise ValueError("batches of at least one try, and at least one worker")
        if self.replans < 0:
            raise ValueError("replans of at least 0")
        if self.limp_friction < 0.0:
            raise ValueError("a limp_friction of at least 0")
        if self.transition_slack < 0 or self.transition_phases not in ("seam", "paper", "best"):
            raise ValueError("a slack of at least 0, and phases seam, paper or best")
        if not self.transition_columns or not self.transition_stretch or min(self.transition_stretch) <= 0:
            raise ValueError("at least one number of columns and one stretch > 0")


@dataclass(frozen=True, eq=False)
class Options:
    """Everything that a run works with besides the robot and the task; None takes a stage's own defaults."""

    simulator: Simulator | Both
    recorder: McapRecorder
    limits: CheckLimits | None = None
    motion: MotionOptions | None = None
    transition: Literal["optimise", "interpolate"] = "optimise"
    """equation (3) is "interpolate" """
    footfall: Mapping[str, Any] = field(default_factory=dict)
    """Keyword arguments of the pattern synthesis (constraint families, solver, seed, time limit)."""
    search: Search = field(default_factory=Search)
    refused: tuple[Refusal, ...] = ()
    """Segments that have failed in simulation"""
    seed: int = 0
