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
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

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
class Point:
    """An iterate: variables, slacks and multipliers."""

    x: Array
    """(free,)"""
    t: Array
    """(sides,) > 0"""
    z: Array
    """(sides,) > 0"""
    y: Array
    """(equal rows,)"""


@dataclass
class Measures:
    """How far a point is from optimal."""

    stationarity: Array
    """(free,) ∇L"""
    off: Array
    """(equal rows,) g − b"""
    short: Array
    """(sides,) gap − t"""
    violation: float
    """Largest violation of a row or bound"""
    dual: float
    """Largest entry of ∇L, scaled as in IPOPT"""
    infeasibility: float
    """Σ |off| + Σ |short|"""
    cost: float


@dataclass
class Step:
    """A Newton direction."""

    x: Array
    t: Array
    z: Array
    y: Array


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
        with self._timed("evaluate"):
            _, rows = self.evaluation.values(x)
        mu = self.rules.initial_barrier
        y = np.zeros(len(self.sides.equal))
        if multipliers is None:
            t = np.maximum(self.sides.gap(x, rows), mu)
            return Point(x, t, mu / t, y)
        near = 0.1 * mu
        t = np.maximum(self.sides.gap(x, rows), near)
        z = np.maximum(self.sides.from_multipliers(multipliers, self.rows), 0.01 * near / t)
        known = np.zeros(self.rows)
        known[: len(multipliers.rows)] = multipliers.rows[: self.rows]
        return Point(x, t, z, known[self.sides.equal])

    def multipliers(self, point: Point) -> Multipliers:
        """Net multipliers of rows and of the full variable vector."""
        force = self.sides.add(-self.sides.sign * point.z)
        bounds = np.zeros(self.structure.size)
        bounds[self.structure.free] = force[: self.free]
        return Multipliers(self._row_multipliers(point, force), bounds)

    # -- the iteration -----------------------------------------------------------------------
    def run(self, point: Point) -> tuple[Point, str]:
        """Iterate; status is solved, stalled, singular or iterations."""
        self._evaluate(point)
        while True:
            now = self._measure(point)
            if self._converged(point, now):
                return point, "solved"
            if self._stalled(now):
                return point, "stalled"
            if self.iterations == self.rules.max_iterations:
                return point, "iterations"
            sigma = point.z / point.t
            weights = self.sides.add(sigma)
            if not self._factor(weights):
                return point, "singular"
            step, mu = self._direction(point, now, sigma, weights)
            following = self._search(point, step, now, mu, halvings=0)
            if following is None:  # the corrector promised too much
                self._evaluate(point)
                plain = self._newton(point, now, sigma, weights, mu - point.z * point.t)
                following = self._search(point, plain, now, mu, halvings=6)
            point = following or point
            self.iterations += 1

    def _evaluate(self, point: Point) -> None:
        with self._timed("evaluate"):
            self.evaluation.derivatives(point.x, self._row_multipliers(point))

    def _row_multipliers(self, point: Point, force: Array | None = None) -> Array:
        force = self.sides.add(-self.sides.sign * point.z) if force is None else force
        rows = force[self.free :].copy()
        rows[self.sides.equal] = point.y
        return rows

    def _measure(self, point: Point) -> Measures:
        found, sides = self.evaluation, self.sides
        force = sides.add(-sides.sign * point.z)
        multipliers = self._row_multipliers(point, force)
        stationarity = found.gradient + found.transposed @ multipliers + force[: self.free]
        off = found.rows[sides.equal] - sides.target
        gap = sides.gap(point.x, found.rows)
        short = gap - point.t
        count = max(1, len(point.y) + len(point.z))
        scale = max(100.0, (np.abs(point.y).sum() + point.z.sum()) / count) / 100.0
        return Measures(
            stationarity,
            off,
            short,
            violation=float(max(np.abs(off).max(initial=0.0), (-gap).max(initial=0.0))),
            dual=float(np.abs(stationarity).max(initial=0.0)) / scale,
            infeasibility=float(np.abs(off).sum() + np.abs(short).sum()),
            cost=found.cost,
        )

    def _converged(self, point: Point, now: Measures) -> bool:
        rules = self.rules
        gap = float(point.z @ point.t)
        small = gap < rules.gap * max(abs(self.evaluation.cost), SMALL_COST)
        return small and now.violation < rules.feasibility and now.dual < rules.tolerance

    def _stalled(self, now: Measures) -> bool:
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
            with self._timed("factor"):
                negative = self.workspace.factor.factor(values)
            if negative == self.rows:
                self.shift = shift if shift > least else 0.0
                return True
            shift = max(1e-2, self.shift / 3.0) if shift == least else 8.0 * shift
        return False

    def _direction(self, point: Point, now: Measures, sigma: Array, weights: Array) -> tuple[Step, float]:
        """Predictor to z t = 0, then the corrected step to the μ that it suggests."""
        product = point.z * point.t
        if not len(product):
            return self._newton(point, now, sigma, weights, product), 0.0
        ahead = self._newton(point, now, sigma, weights, -product)
        primal, dual = _longest(point.t, ahead.t, 1.0), _longest(point.z, ahead.z, 1.0)
        mean = float(product.mean())
        after = float(((point.t + primal * ahead.t) * (point.z + dual * ahead.z)).mean())
        residual = max(now.dual, float(np.abs(now.off).max(initial=0.0)), float(np.abs(now.short).max(initial=0.0)))
        mu = max(min(after / mean, 1.0) ** 3 * mean, min(mean, FLOOR * residual), 1e-10)
        return self._newton(point, now, sigma, weights, mu - product - ahead.t * ahead.z), mu

    def _newton(self, point: Point, now: Measures, sigma: Array, weights: Array, change: Array) -> Step:
        """The step that changes z t by `change` to first order; Δz = change / t − Σ Δt, Δt = sign Δc + short."""
        sides, free = self.sides, self.free
        push = change / point.t
        pull = sides.add(sides.sign * (sigma * now.short - push))
        right = np.empty(self.structure.dimension)
        right[:free] = -now.stationarity - pull[:free]
        rows = right[free:]
        rows[sides.equal] = -now.off
        rows[sides.loose] = -pull[free:][sides.loose] / np.maximum(weights[free:][sides.loose], LEAST)
        with self._timed("solve"):
            solved = self.workspace.factor.solve(right)
        dx = solved[:free]
        dt = sides.along(dx, self.evaluation.jacobian @ dx) + now.short
        return Step(dx, dt, push - sigma * dt, solved[free:][sides.equal])

    def _search(self, point: Point, step: Step, now: Measures, mu: float, halvings: int) -> Point | None:
        """The next point, derivatives evaluated; a search without halvings may fail, another takes its last try."""
        fraction = max(0.995, 1.0 - mu)
        length, dual = _longest(point.t, step.t, fraction), _longest(point.z, step.z, fraction)
        before = now.infeasibility, now.cost - mu * float(np.log(point.t).sum())
        z = point.z + dual * step.z
        for halving in range(halvings + 1):
            x, y = point.x + length * step.x, point.y + length * step.y
            trial = Point(x, point.t + length * step.t, z, y)
            if halving == 0:  # nearly always taken, so everything is evaluated at once
                self._evaluate(trial)
                cost, rows = self.evaluation.cost, self.evaluation.rows
            else:
                with self._timed("evaluate"):
                    cost, rows = self.evaluation.values(x)
            gap = self.sides.gap(x, rows)
            trial.t = np.maximum(trial.t, gap)
            off = rows[self.sides.equal] - self.sides.target
            infeasibility = float(np.abs(off).sum() + np.abs(gap - trial.t).sum())
            if _better(before, (infeasibility, cost - mu * float(np.log(trial.t).sum()))):
                break
            length *= 0.5
        else:
            if not halvings:
                return None
        if halving:
            self._evaluate(trial)
        return trial

    @contextmanager
    def _timed(self, what: str) -> Iterator[None]:
        begin = time.process_time()
        yield
        self.timings[what] += time.process_time() - begin


def _better(before: tuple[float, float], after: tuple[float, float]) -> bool:
    """Has infeasibility or the barrier function (in this order) become smaller?"""
    nearer = before[0] > FEASIBLE and after[0] <= (1.0 - BETTER) * before[0]
    rounding = 1e-9 * max(1.0, abs(before[1]))
    return nearer or after[1] <= before[1] - BETTER * before[0] + rounding


def _longest(values: Array, change: Array, fraction: float) -> float:
    """The longest step ≤ 1 that keeps values > 0, short of the boundary by `fraction`."""
    ratio = np.divide(values, -change, out=np.full_like(values, np.inf), where=change < 0)
    return float(min(1.0, fraction * ratio.min(initial=np.inf)))
