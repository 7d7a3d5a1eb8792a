"""Tries at a motion plan, one after the other or several at once in processes of their own."""

from __future__ import annotations

import os
import time
from collections.abc import Mapping, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, field, replace
from multiprocessing import active_children, current_process, get_context
from types import TracebackType
from typing import Any, Literal

from gaitforge.errors import InfeasibleMotion, UnsolvedError
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import MotionPlan
from gaitforge.pipeline.search.segment import Attempt
from gaitforge.robot.model import RobotModel

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


@dataclass(frozen=True, eq=False)
class Try:
    """One call of `plan_gait` or `plan_transition`."""

    what: str
    """In words, for the summary."""
    kind: Literal["gait", "transition"]
    robot: RobotModel
    positional: tuple[Any, ...]
    """What comes after the robot."""
    named: Mapping[str, Any]

    def plan(self) -> MotionPlan:
        """The motion plan; errors as those of the function that is called."""
        if self.kind == "gait":
            from gaitforge.motion.gait import plan_gait

            return plan_gait(self.robot, *self.positional, **self.named)
        from gaitforge.motion.transition import plan_transition

        return plan_transition(self.robot, *self.positional, **self.named)


@dataclass(frozen=True, eq=False)
class Result:
    """What a try came to: a plan, or the error that says why there is none."""

    what: str
    plan: MotionPlan | None
    error: UnsolvedError | InfeasibleMotion | None
    seconds: float

    @property
    def left(self) -> Attempt:
        """The entry of a try that was left because it has no plan."""
        return Attempt(self.what, str(self.error), self.seconds)


def attempt(one: Try) -> Result:
    """Make the try; an error that is no answer of the planner's leaves this function."""
    begin = time.perf_counter()
    try:
        return Result(one.what, one.plan(), None, time.perf_counter() - begin)
    except (UnsolvedError, InfeasibleMotion) as error:
        return Result(one.what, None, error, time.perf_counter() - begin)


def unexplained(options: MotionOptions | None) -> MotionOptions:
    """Options for one try of many: why it has no plan is asked of one of them, when all have failed."""
    return replace(options or MotionOptions(), explain=False)


def quick(options: MotionOptions) -> MotionOptions:
    """The options without a slow second solver: there is something else to try."""
    from gaitforge.motion.solvers.structured import Structured

    solver = options.solver
    return replace(options, solver=replace(solver, fallback=None)) if isinstance(solver, Structured) else options


def why(one: Try | None) -> dict[str, Any]:
    """The ``explain`` entry of a try that has no plan, found by making it again and asking; none for None."""
    if one is None:
        return {}
    told = attempt(replace(one, named={**one.named, "options": replace(one.named["options"], explain=True)}))
    return {} if told.error is None else dict(told.error.explain)


def cheapest(results: Sequence[Result]) -> tuple[MotionPlan | None, list[Attempt]]:
    """(the plan that relaxed least and cost least, the first of equals; the attempts that were left)."""
    solved = [(r, r.plan) for r in results if r.plan is not None]
    if not solved:
        return None, [r.left for r in results]
    chosen, plan = min(solved, key=lambda pair: (len(pair[1].relaxed), pair[1].report.cost))
    others = [r.left if r.plan is None else _dearer(r, r.plan, plan) for r in results if r is not chosen]
    return plan, others


def _dearer(result: Result, plan: MotionPlan, chosen: MotionPlan) -> Attempt:
    more = "; ".join(plan.relaxed) if len(plan.relaxed) > len(chosen.relaxed) else ""
    why = f"relaxed {more}" if more else f"cost {plan.report.cost:.4g}, another has {chosen.report.cost:.4g}"
    return Attempt(result.what, why, result.seconds)


@dataclass
class Workers:
    """This process and `count` − 1 beside it, started when first needed; use as a context.

    What comes out depends neither on `count` nor on which try ends first.
    """

    count: int = 1
    _pool: ProcessPoolExecutor | None = field(default=None, repr=False)

    def run(self, tries: Sequence[Try]) -> list[Result]:
        """The results of all tries, in their order; the first is made here, where no process has to be started.

        Where other work keeps the cores busy all of them are made here: side by side they would only be slower.
        """
        if self.count < 2 or len(tries) < 2 or current_process().daemon or not room_for_more():
            return [attempt(one) for one in tries]
        futures = [self._submit(one) for one in tries[1:]]
        results = [attempt(tries[0])]
        for one, future in zip(tries[1:], futures, strict=True):
            results.append(self._collect(one, future))
        return results

    def _submit(self, one: Try) -> Future[Result]:
        if self._pool is None:
            context = get_context("spawn")
            self._pool = ProcessPoolExecutor(self.count - 1, context, initializer=_one_thread)
        return self._pool.submit(attempt, replace(one, robot=replace(one.robot)))  # without what the model has cached

    def _collect(self, one: Try, future: Future[Result]) -> Result:
        """The result of a try elsewhere; one that has not begun yet, or whose process has died, is made here."""
        if future.cancel():
            return attempt(one)
        try:
            return future.result()
        except BrokenProcessPool:
            self.close()
            return attempt(one)

    def close(self) -> None:
        """End the processes that were started."""
        if self._pool is not None:
            self._pool.shutdown(wait=False, cancel_futures=True)
            self._pool = None

    def __enter__(self) -> Workers:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if error is not None and self._pool is not None:  # nobody waits for what is still running
            for process in active_children():
                process.terminate()
        self.close()


def room_for_more() -> bool:
    """Whether a core is likely to be free: the load of the last minute, this process's own included."""
    if not hasattr(os, "getloadavg"):
        return True
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return os.getloadavg()[0] <= cores - 0.5


def _one_thread() -> None:
    """Before anything heavy is loaded: processes are the parallelism."""
    os.environ.update(dict.fromkeys(THREADS, "1"))
