"""A transition is planned where it is best, and at the first gait's own seam where that cannot be started."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from gaitforge.errors import UnsolvedError
from gaitforge.experiment.change import ChangeJob
from gaitforge.experiment.experiment import Tools
from gaitforge.experiment.gaits import GaitCase, PlannedGait
from gaitforge.pipeline.options import Options
from gaitforge.task.phase import Phase


def job(plans: Any) -> ChangeJob:
    first, second = (GaitCase("hexapod", Phase(name)) for name in ("a", "b"))
    return ChangeJob(first, second, "optimise", (3, 4), plans=plans)


def tools() -> Tools:
    return Tools(Options(None, None), {})  # type: ignore[arg-type]


@pytest.fixture
def planning(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """Planning by names alone: what was asked for is kept in `leaves`; gaits begun elsewhere cannot be started."""
    kept = SimpleNamespace(leaves=[], parts=[], startable=False)

    def plan_change(robot: Any, before: Any, after: Any, options: Options, watch: Any, leave: int | None) -> Any:
        kept.leaves.append((leave, options.search.transition_phases, options.transition))
        column = 4 if leave is None else leave
        return SimpleNamespace(plan=SimpleNamespace(pattern=SimpleNamespace(info={"from_column": column})))

    def plan_start(robot: Any, gait: Any, options: Any) -> str:
        if not kept.startable:
            raise UnsolvedError("in its own way")
        return "start of the turned gait"

    monkeypatch.setattr("gaitforge.pipeline.search.transitions.plan_change", plan_change)
    monkeypatch.setattr("gaitforge.pipeline.search.transitions.meeting", lambda a, b, pattern, options: ("turned", b))
    monkeypatch.setattr("gaitforge.motion.stand.plan_start", plan_start)
    monkeypatch.setattr("gaitforge.motion.timeline_build.build_timeline", lambda robot, parts, scene: parts)
    return kept


PLANS = tuple(PlannedGait(f"gait {n}", f"start {n}", 0.0) for n in ("a", "b"))  # type: ignore[arg-type]


def test_a_gait_that_cannot_be_started_where_it_is_left_is_left_at_its_own_seam(planning: SimpleNamespace) -> None:
    change, parts = job(PLANS)._planned(tools())
    assert planning.leaves == [(None, "best", "optimise"), (0, "best", "optimise")]
    assert [cycles for _, cycles in parts] == [1, 3, 1, 4]
    assert parts[0][0] == "start a"
    assert change.plan.pattern.info == {"from_column": 0}


def test_one_that_can_be_started_there_gets_a_start_of_its_own(planning: SimpleNamespace) -> None:
    planning.startable = True
    _, parts = job(PLANS)._planned(tools())
    assert [leave for leave, *_ in planning.leaves] == [None]
    assert parts[0][0] == "start of the turned gait"


def test_a_gait_that_has_no_plan_is_the_rows_answer() -> None:
    with pytest.raises(UnsolvedError, match="no plan for b"):
        job((PLANS[0], UnsolvedError("no plan for b"))).measure(tools())
