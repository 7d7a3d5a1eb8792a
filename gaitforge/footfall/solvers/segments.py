"""The search over change times first, the general model for whatever it does not understand: the default."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar

from gaitforge.footfall.constraints import ConstraintSet
from gaitforge.footfall.constraints.base import require_at_least
from gaitforge.footfall.problem import FootfallProblem
from gaitforge.footfall.program import Program
from gaitforge.footfall.segments.listing import tied_patterns
from gaitforge.footfall.segments.optimum import optimum
from gaitforge.footfall.segments.reading import NotUnderstood, read
from gaitforge.footfall.solvers.base import FootfallSolver, Listing, Solution
from gaitforge.footfall.solvers.cpsat import CpSat


@dataclass(frozen=True)
class Segments:
    """Searches over k change times and one mask of segments per limb; exact, and without any solver.

    It takes families by their scopes and data: rules on rows with at most two changes, one balance, stance
    clauses, one gap rule.  Everything else goes to `general`.
    """

    name: ClassVar[str] = "segments"

    largest: int = 200_000
    """[sets of times] most that are looked at for one number of change times"""
    effort: int = 100_000
    """[steps] most that the placing of limbs may take; about a second"""
    general: FootfallSolver = field(default_factory=CpSat)
    """Takes the general model."""

    def __post_init__(self) -> None:
        for name in ("largest", "effort"):
            require_at_least("footfall/solver", name, getattr(self, name), 1)

    def search(self, problem: FootfallProblem, families: Sequence[ConstraintSet]) -> tuple[Solution, str]:
        """The optimum, a proof that there is none, or *unknown* with the reason why the general model is needed."""
        start = time.perf_counter()
        try:
            reading = read(problem, families)
        except NotUnderstood as reason:
            return Solution("unknown", bound=0, build_s=time.perf_counter() - start), str(reason)
        built = time.perf_counter()
        found = optimum(reading, self.largest, self.effort)
        taken = built - start, time.perf_counter() - built
        if found.contact is not None:
            return Solution("optimal", found.contact, found.bound, found.bound, *taken), ""
        if found.proven:
            return Solution("infeasible", None, None, None, *taken), ""
        return Solution("unknown", None, None, found.bound, *taken), "too many change times to look at"

    def ties(
        self, problem: FootfallProblem, families: Sequence[ConstraintSet], most_changes: int, limit: int
    ) -> Listing | None:
        """Up to about `limit` distinct patterns with Σ y ≤ `most_changes`, of a gait one rotation each.

        When there are more, they are spread evenly over all.  None when the general model has to list them.
        """
        start = time.perf_counter()
        try:
            reading = read(problem, families)
        except NotUnderstood:
            return None
        found = tied_patterns(reading, most_changes, limit, self.largest, self.effort)
        if found is None:
            return None
        return Listing(found.contacts, found.complete, time.perf_counter() - start)

    def minimize(self, program: Program, time_limit_s: float, seed: int) -> Solution:
        """The general model's answer."""
        return self.general.minimize(program, time_limit_s, seed)

    def is_feasible(self, program: Program, time_limit_s: float, seed: int) -> bool | None:
        """The general model's answer."""
        return self.general.is_feasible(program, time_limit_s, seed)

    def listing(self, program: Program, *, most_changes: int, limit: int, time_limit_s: float, seed: int) -> Listing:
        """The general model's answer."""
        return self.general.listing(
            program, most_changes=most_changes, limit=limit, time_limit_s=time_limit_s, seed=seed
        )
