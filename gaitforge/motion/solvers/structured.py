"""The fast solver: interior points on a structure that is analysed once, and a second start where it stalls."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace

from gaitforge.motion.problem import Problem
from gaitforge.motion.solvers.elastic import relax
from gaitforge.motion.solvers.interior_point import InteriorPoint, Rules
from gaitforge.motion.solvers.ipopt import Ipopt
from gaitforge.motion.solvers.solution import MotionSolver, Solution, Start
from gaitforge.motion.solvers.workspace import workspace_of

NEAREST = (40, 100)
"""Iterations towards the least violated point: near is near enough as a rule, and an answer is wanted soon"""
FEW = 60
"""Rows in the way of a point that is worth the second number of iterations"""
DOUBTFUL = 5
"""Rows in the way of a point that is so near to a solution that another method may find one"""


@dataclass(frozen=True)
class Structured:
    """Primal–dual interior points with exact derivatives, see `interior_point`.

    What does not depend on numbers (places of the kernels' outputs, pattern and ordering of the KKT
    matrix, buffers) is remembered for problems of the same structure.
    """

    max_iterations: int = 60
    tolerance: float = 1e-6
    """Largest entry of ∇L, scaled by the size of the multipliers"""
    residual: float = 1e-7
    """Largest violation of a row or bound that counts as solved [SI units of the row]"""
    gap: float = 1e-5
    """Σ z t, how much the bounds' barrier may still cost, as a share of the cost"""
    initial_barrier: float = 1e-2
    regularisation: float = 1e-8
    """On the diagonal of the KKT matrix, so that no pivot is zero"""
    patience: int = 15
    """Iterations in which infeasibility has to halve"""
    native: bool = True
    """Use code compiled on this machine where there is a C compiler; slower without, otherwise the same"""
    restoration: bool = True
    """After a failure, begin again where the problem is violated least; that point says who is in the way"""
    fallback: MotionSolver | None = field(default_factory=Ipopt)
    """Asked when restoration fails although next to nothing is in the way (at once without it); None: failures stand"""

    def solve(self, problem: Problem, start: Start = None) -> Solution:
        """Solve from `start` (the problem's own guess when None)."""
        begin = time.perf_counter()
        found = self._solve(problem, start)
        if not found.solved and self.restoration:
            found = self._restored(problem, found)
        if not found.solved and self.fallback is not None and len(found.violations or ()) <= DOUBTFUL:
            other = self.fallback.solve(problem, start)
            status = f"{other.status} (structured: {found.status})"
            spent = found.iterations + other.iterations
            found = replace(other, status=status, iterations=spent, violations=found.violations)
        return replace(found, seconds=time.perf_counter() - begin)

    def nearest(self, problem: Problem, iterations: int = NEAREST[-1]) -> Solution:
        """The point that violates the problem least, with `violations` (none: it is feasible)."""
        relaxed = relax(problem)
        easy = replace(self, max_iterations=iterations, patience=iterations, tolerance=1e-4, gap=1e-3)
        near = easy._solve(relaxed.problem, None)
        left = relaxed.violations(near.x)
        return replace(near, x=near.x[: problem.size], multipliers=None, violations=left)

    def _restored(self, problem: Problem, failed: Solution) -> Solution:
        """The solution found from the least violated point, or the failure with what is in the way."""
        tried = [failed]
        for iterations in NEAREST:
            near = self.nearest(problem, iterations)
            again = self._solve(problem, near.x)
            tried += [near, again]
            if again.solved or near.solved or len(near.violations or ()) > FEW:
                break
        kept = again if again.solved else replace(failed, violations=near.violations)
        timings = {k: sum(t.timings[k] for t in tried) for k in failed.timings}
        return replace(kept, iterations=sum(t.iterations for t in tried), timings=timings)

    def _solve(self, problem: Problem, start: Start) -> Solution:
        begin, busy = time.perf_counter(), time.process_time()
        workspace = workspace_of(problem, self.native)
        structure = workspace.structure
        prepared = time.process_time() - busy
        known = start.multipliers if isinstance(start, Solution) else None
        x = start.x if isinstance(start, Solution) else problem.x0 if start is None else start
        method = InteriorPoint(problem, workspace, self._rules())
        point, status = method.run(method.begin(x[structure.free], known))
        full = problem.bounds[0].copy()  # constants stand at their bounds
        full[structure.free] = point.primals.x
        worst = problem.violations(full, workspace.evaluation.rows)
        timings = {"structure": prepared, **method.timings}
        rest = time.process_time() - busy - sum(timings.values())
        return Solution(
            full,
            status == "solved",
            status,
            method.iterations,
            time.perf_counter() - begin,
            workspace.evaluation.cost,
            float(max((v[0] for v in worst.values()), default=0.0)),
            worst,
            method.multipliers(point),
            {**timings, "rest": rest},
        )

    def _rules(self) -> Rules:
        return Rules(
            self.max_iterations,
            self.tolerance,
            self.residual,
            self.gap,
            self.initial_barrier,
            self.regularisation,
            self.patience,
        )
