"""One batch of tries: what no simulator has refused, planned at once, and the cheapest of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from gaitforge.pipeline.options import Options
from gaitforge.pipeline.search.refusals import allowed
from gaitforge.pipeline.search.segment import Attempt
from gaitforge.pipeline.search.sparing import spared
from gaitforge.pipeline.search.tries import Result, Try, Workers, cheapest
from gaitforge.pipeline.stopwatch import Stopwatch


@dataclass(frozen=True, eq=False)
class Batch:
    """What was tried, and what came of it."""

    tries: Sequence[Try]
    """Those that no simulator has refused"""
    results: Sequence[Result]
    """One for each"""
    taken: Result | None
    """The cheapest, planned again where it asked too much of the motors; None without a plan"""
    left: Sequence[Attempt]
    """The others, the refused ones first"""


def run_batch(tries: Sequence[Try], name: str, options: Options, watch: Stopwatch, workers: Workers) -> Batch:
    """Plan the tries for the segment `name`."""
    asked, barred = allowed(tries, options.refused)
    if not asked:
        return Batch((), (), None, barred)
    with watch.stage("motion"):
        results = workers.run(asked)
    plan, others = cheapest(results)
    for one in others:
        watch.progress("motion", f"{name}: {one.what}: left ({one.why})")
    if plan is None:
        return Batch(asked, results, None, [*barred, *others])
    with watch.stage("motion"):
        taken = next(spared(t, r) for t, r in zip(asked, results, strict=True) if r.plan is plan)
    return Batch(asked, results, taken, [*barred, *others])
