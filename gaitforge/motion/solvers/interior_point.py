r"""A primal–dual interior-point method on the nonlinear problem itself, with exact second derivatives.

    minimise f(x)   subject to   g_i(x) = b_i for equal rows,   sign · c(x) − bound ≥ 0 for every side of (x, g)

Each side has a slack t > 0 and a multiplier z > 0, sign · c − bound − t = 0, and may be violated by the
starting point, which is never moved.  Newton's method on the optimality conditions with z t = μ needs one
factorisation of K (`structure`) an iteration: Δt and Δz are eliminated, Σ = z / t; a side of a variable adds Σ
to the diagonal, a row with room has −1/Σ on its own.  Mehrotra's predictor chooses μ and corrects; a step
has to make infeasibility or the barrier function smaller (a filter of one point, Fletcher & Leyffer 2002), else it
is taken again without the corrector, and shorter; δ_w grows until K has as many negative pivots as there are rows,
so that steps lead downhill (inertia, Wächter & Biegler 2006).
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.problem import Problem
from gaitforge.motion.solvers.sides import Sides
from gaitforge.motion.solvers.solution import Multipliers
from gaitforge.motion.solvers.workspace import Workspace

Array = NDArray[np.float64]
BETTER = 1e-5
"""Share by which a step must improve infeasibility or the barrier function"""
SMALL_COST = 0.1
"""Below this the gap counts absolutely"""
FLOOR = 1e-5
"""μ does not run ahead of the residuals by more than this factor"""
FAR = 1e3
"""Violations below this many times the feasibility asked for are no stall"""
FEASIBLE = 1e-9
"""Infeasibility that is not worth a step"""
LEAST = 1e-12
"""Smallest Σ of a row, so that 1/Σ is finite"""


@dataclass(frozen=True)
class Rules:
    """When to stop, and how to begin."""

    max_iterations: int
    tolerance: float
    feasibility: float
    gap: float
    initial_barrier: float
    regularisation: float
    patience: int


@dataclass
class Duals:
    """Multipliers, and what they push with."""

    z: Array
    """(sides,) > 0"""
    y: Array
    """(equal rows,)"""
    bounds: Array
    """(free,) Σ −sign z of the sides of each variable"""
    rows: Array
    """(rows,) y, and for rows with room the same as for variables"""


@dataclass
class Primals:
    """Variables and slacks, and how far they are from feasible."""

    x: Array
    """(free,)"""
    t: Array
    """(sides,) > 0"""
    off: Array
    """(equal rows,) g − b"""
    short: Array
    """(sides,) gap − t"""
    violation: float
    """Largest violation of a row or bound"""
    infeasibility: float
    """Σ |off| + Σ |short|"""
    cost: float


@dataclass
class Point:
    """An iterate, at which derivatives were evaluated last."""

    primals: Primals
    duals: Duals
    stationarity: Array
    """(free,) ∇L"""
    dual: float
    """Largest entry of ∇L, scaled as in IPOPT"""


@dataclass
class Step:
    """A Newton direction; slacks and their multipliers are two rows, which have lengths of their own."""

    x: Array
    y: Array
    tz: Array
    """(2, sides)"""


class InteriorPoint:
    """One solve; `run` iterates until a status is reached."""

    def __init__(self, problem: Problem, workspace: Workspace, rules: Rules) -> None:
        self.rules, self.workspace = rules, workspace
        self.evaluation, self.structure = workspace.evaluation, workspace.structure
        self.evaluation.load(problem)
        self.sides = Sides(problem, self.structure)
        self.free = len(self.structure.free)
        self.rows = self.structure.row_count
        self.iterations = 0
        self.shift = 0.0
        self.timings = {"evaluate": 0.0, "factor": 0.0, "solve": 0.0}
        self._history: list[float] = []

    # -- beginning and end -----------------------------------------------------------------
    def begin(self, x: Array, multipliers: Multipliers | None) -> Point:
        """Slacks that are positive wherever x lies; z t = μ, or the multipliers of a similar problem."""
        self._evaluate(x, np.zeros(self.rows))
        cost, rows = self.evaluation.cost, self.evaluation.rows
        mu, gap = self.rules.initial_barrier, self.sides.gap(x, rows)
        if multipliers is None:
            t = np.maximum(gap, mu)
            duals = self._duals(mu / t, np.zeros(len(self.sides.equal)))
        else:
            near = 0.1 * mu
            t = np.maximum(gap, near)
            z = np.maximum(self.sides.from_multipliers(multipliers, self.rows), 0.01 * near / t)
            known = np.zeros(self.rows)
            known[: len(multipliers.rows)] = multipliers.rows[: self.rows]
            duals = self._duals(z, known[self.sides.equal])
        primals = self._primals(x, t, gap, rows, cost)
        if duals.rows.any():  # known from before, or of rows with room
            self._evaluate(x, duals.rows)
        return self._point(primals, duals)

    def multipliers(self, point: Point) -> Multipliers:
        """Net multipliers of rows and of the full variable vector."""
        bounds = np.zeros(self.structure.size)
        bounds[self.structure.free] = point.duals.bounds
        return Multipliers(point.duals.rows.copy(), bounds)

    # -- the iteration -----------------------------------------------------------------------
    def run(self, point: Point) -> tuple[Point, str]:
        """Iterate; status is solved, stalled, singular or iterations."""
        while True:
            if self._converged(point):
                return point, "solved"
            if self._stalled(point.primals):
                return point, "stalled"
            if self.iterations == self.rules.max_iterations:
                return point, "iterations"
            sigma = point.duals.z / point.primals.t
            weights = self.sides.add(sigma)
            if not self._factor(weights):
                return point, "singular"
            pinned = np.maximum(weights[self.free :][self.sides.loose], LEAST)
            newton = partial(self._newton, point, sigma, pinned)
            step, mu = self._direction(point, newton)
            following = self._search(point, step, mu, halvings=0)
            if following is None:  # the corrector promised too much
                self._evaluate(point.primals.x, point.duals.rows)
                plain = newton(mu - point.duals.z * point.primals.t)
                following = self._search(point, plain, mu, halvings=6)
            point = following or point
            self.iterations += 1

    def _evaluate(self, x: Array, multipliers: Array) -> None:
        begin = time.process_time()
        self.evaluation.derivatives(x, multipliers)
        self._spent("evaluate", begin)

    def _duals(self, z: Array, y: Array) -> Duals:
        force = self.sides.add(-self.sides.sign * z)
        rows = force[self.free :]
        rows[self.sides.equal] = y
        return Duals(z, y, force[: self.free], rows)

    def _primals(self, x: Array, t: Array, gap: Array, rows: Array, cost: float) -> Primals:
        off, short = rows[self.sides.equal] - self.sides.target, gap - t
        wrong = np.abs(off)
        violation = max(float(wrong.max(initial=0.0)), -float(gap.min(initial=0.0)))
        return Primals(x, t, off, short, violation, float(wrong.sum() + np.abs(short).sum()), cost)

    def _point(self, primals: Primals, duals: Duals) -> Point:
        """With the derivatives that were evaluated last."""
        found = self.evaluation
        stationarity = found.gradient + found.transposed @ duals.rows + duals.bounds
        count = max(1, len(duals.y) + len(duals.z))
        scale = max(100.0, float(np.abs(duals.y).sum() + duals.z.sum()) / count) / 100.0
        return Point(primals, duals, stationarity, float(np.abs(stationarity).max(initial=0.0)) / scale)

    def _converged(self, point: Point) -> bool:
        rules, primals = self.rules, point.primals
        gap = float(point.duals.z @ primals.t)
        small = gap < rules.gap * max(abs(primals.cost), SMALL_COST)
        return small and primals.violation < rules.feasibility and point.dual < rules.tolerance

    def _stalled(self, now: Primals) -> bool:
        """Has infeasibility not halved for as long as patience lasts?"""
        far = now.violation > FAR * self.rules.feasibility
        self._history.append(now.infeasibility if far else np.inf)
        if len(self._history) <= self.rules.patience or not far:
            return False
        return now.infeasibility > 0.5 * self._history[-1 - self.rules.patience]

    def _factor(self, weights: Array) -> bool:
        """Factor K, with δ_w raised until its inertia is right; False when that never happens."""
        diagonal, free = self.structure.diagonal, self.free
        rows = np.full(self.rows, -self.rules.regularisation)
        rows[self.sides.loose] = -1.0 / np.maximum(weights[free:][self.sides.loose], LEAST)
        values, least = self.evaluation.kkt.copy(), self.rules.regularisation
        values[diagonal[free:]] += rows
        upper = values[diagonal[:free]] + weights[:free]
        shift = least
        while shift < 1e10:
            values[diagonal[:free]] = upper + shift
            begin = time.process_time()
            negative = self.workspace.factor.factor(values)
            self._spent("factor", begin)
            if negative == self.rows:
                self.shift = shift if shift > least else 0.0
                return True
            shift = max(1e-2, self.shift / 3.0) if shift == least else 8.0 * shift
        return False

    def _direction(self, point: Point, newton: Callable[[Array], Step]) -> tuple[Step, float]:
        """Predictor to z t = 0, then the corrected step to the μ that it suggests."""
        primals = point.primals
        both = np.stack([primals.t, point.duals.z])
        product = both[0] * both[1]
        if not len(product):
            return newton(product), 0.0
        ahead = newton(-product)
        t, z = both + _longest(both, ahead.tz, 1.0)[:, None] * ahead.tz
        mean, after = float(product.mean()), float(t @ z) / len(product)
        residual = max(point.dual, *(float(np.abs(r).max(initial=0.0)) for r in (primals.off, primals.short)))
        mu = max(min(after / mean, 1.0) ** 3 * mean, min(mean, FLOOR * residual), 1e-10)
        return newton(mu - product - ahead.tz[0] * ahead.tz[1]), mu

    def _newton(self, point: Point, sigma: Array, pinned: Array, change: Array) -> Step:
        """The step that changes z t by `change` to first order; Δz = change / t − Σ Δt, Δt = sign Δc + short.

        `pinned`: Σ of the rows with room.
        """
        sides, free, primals = self.sides, self.free, point.primals
        push = change / primals.t
        pull = sides.add(sides.sign * (sigma * primals.short - push))
        right = np.empty(self.structure.dimension)
        np.add(point.stationarity, pull[:free], out=right[:free])
        rows = right[free:]
        rows[sides.equal] = primals.off
        rows[sides.loose] = pull[free:][sides.loose] / pinned
        begin = time.process_time()
        solved = self.workspace.factor.solve(np.negative(right, out=right))
        self._spent("solve", begin)
        dx, tz = solved[:free], np.empty((2, len(sigma)))
        np.add(sides.along(dx, self.evaluation.jacobian @ dx), primals.short, out=tz[0])
        np.subtract(push, sigma * tz[0], out=tz[1])
        return Step(dx, solved[free:][sides.equal], tz)

    def _search(self, point: Point, step: Step, mu: float, halvings: int) -> Point | None:
        """The next point, derivatives evaluated; a search without halvings may fail, another takes its last try."""
        old, duals = point.primals, point.duals
        lengths = _longest(np.stack([old.t, duals.z]), step.tz, max(0.995, 1.0 - mu))
        length, z = float(lengths[0]), duals.z + lengths[1] * step.tz[1]
        before = old.infeasibility, old.cost - mu * float(np.log(old.t).sum())
        for halving in range(halvings + 1):
            x, ahead = old.x + length * step.x, self._duals(z, duals.y + length * step.y)
            if halving == 0:  # nearly always taken, so everything is evaluated at once
                self._evaluate(x, ahead.rows)
                cost, rows = self.evaluation.cost, self.evaluation.rows
            else:
                begin = time.process_time()
                cost, rows = self.evaluation.values(x)
                self._spent("evaluate", begin)
            gap = self.sides.gap(x, rows)
            trial = self._primals(x, np.maximum(old.t + length * step.tz[0], gap), gap, rows, cost)
            if _better(before, (trial.infeasibility, cost - mu * float(np.log(trial.t).sum()))):
                break
            length *= 0.5
        else:
            if not halvings:
                return None
        if halving:
            self._evaluate(x, ahead.rows)
        return self._point(trial, ahead)

    def _spent(self, what: str, begin: float) -> None:
        self.timings[what] += time.process_time() - begin


def _better(before: tuple[float, float], after: tuple[float, float]) -> bool:
    """Has infeasibility or the barrier function (in this order) become smaller?"""
    nearer = before[0] > FEASIBLE and after[0] <= (1.0 - BETTER) * before[0]
    rounding = 1e-9 * max(1.0, abs(before[1]))
    return nearer or after[1] <= before[1] - BETTER * before[0] + rounding


def _longest(values: Array, change: Array, fraction: float) -> Array:
    """(2,) the longest steps ≤ 1 that keep each row of values (2, n) > 0, short of the boundary by `fraction`."""
    fastest = -(change / values).min(axis=1, initial=0.0)
    return np.asarray(fraction / np.maximum(fastest, fraction))
