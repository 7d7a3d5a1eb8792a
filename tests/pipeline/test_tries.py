"""Several tries at once: the same results as one after the other, and the cheapest of them chosen."""

from __future__ import annotations

import time
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
from multiprocessing import active_children
from multiprocessing.connection import wait
from multiprocessing.process import BaseProcess
from typing import Any

import numpy as np
import pytest

from gaitforge.errors import InfeasibleMotion, InputError, UnsolvedError
from gaitforge.footfall.given import alternating
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion.plan import Command, MotionPlan
from gaitforge.motion.report import SolveReport
from gaitforge.pipeline.search.tries import Result, Try, Workers, attempt, cheapest, room_for_more
from gaitforge.robot.load import load_robot
from gaitforge.robot.model import RobotModel


@pytest.fixture(scope="module")
def hexapod() -> RobotModel:
    return load_robot("hexapod")


def plan(cost: float, relaxed: tuple[str, ...] = ()) -> MotionPlan:
    pattern = FootfallPattern(np.ones((1, 1), dtype=bool), ("L1",))
    empty = np.zeros((1, 2))
    return MotionPlan(
        "a", "gait", pattern, np.array([0.0, 1.0]), empty, empty, empty, empty, empty, Command(),
        report=SolveReport(cost=cost), relaxed=relaxed,
    )  # fmt: skip


def solved(what: str, cost: float, relaxed: tuple[str, ...] = ()) -> Result:
    return Result(what, plan(cost, relaxed), None, 0.1)


def failed(what: str) -> Result:
    return Result(what, None, UnsolvedError(f"{what} gave nothing"), 0.1)


def test_the_cheapest_is_kept_and_the_others_say_why_they_were_left() -> None:
    results = [solved("a", 3.0), failed("b"), solved("c", 2.0), solved("d", 2.5)]
    chosen, left = cheapest(results)
    assert chosen is results[2].plan
    assert [(a.what, a.why) for a in left] == [
        ("a", "cost 3, another has 2"), ("b", "b gave nothing"), ("d", "cost 2.5, another has 2"),
    ]  # fmt: skip


def test_a_relaxed_plan_is_left_for_one_that_keeps_every_demand() -> None:
    results = [solved("a", 1.0, ("stability share 0.3",)), solved("b", 9.0)]
    chosen, left = cheapest(results)
    assert chosen is results[1].plan
    assert left[0].why == "relaxed stability share 0.3"


def test_of_equal_costs_the_first_is_kept() -> None:
    results = [failed("a"), solved("b", 1.0), solved("c", 1.0)]
    assert cheapest(results)[0] is results[1].plan


def test_when_none_has_a_plan_all_are_left() -> None:
    chosen, left = cheapest([failed("a"), failed("b")])
    assert chosen is None
    assert [a.what for a in left] == ["a", "b"]


def tries(robot: RobotModel) -> list[Try]:
    """A gait that can be planned, one that cannot, and one more that can."""
    sides = [limb.side for limb in robot.limbs]
    tripod = alternating(robot.limb_names, sides, 8)
    named: dict[str, Any] = {"samples_per_column": 1}
    return [
        Try("tripod", "gait", robot, (tripod,), named),
        Try("too fast", "gait", robot, (tripod,), {**named, "speed": 3.0}),
        Try("later tripod", "gait", robot, (tripod.rotated(4),), named),
    ]


@pytest.fixture
def idle(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("gaitforge.pipeline.search.tries.room_for_more", lambda: True)


@pytest.mark.usefixtures("idle")
def test_processes_give_what_one_process_gives_in_the_order_of_the_tries(hexapod: RobotModel) -> None:
    asked = tries(hexapod)
    alone = Workers(1).run(asked)
    with Workers(2) as workers:
        together = workers.run(asked)
    assert [r.what for r in together] == [r.what for r in alone] == ["tripod", "too fast", "later tripod"]
    assert [r.plan is None for r in together] == [r.plan is None for r in alone] == [False, True, False]
    for one, other in zip(alone, together, strict=True):
        if one.plan is not None and other.plan is not None:
            assert (one.plan.joint_positions == other.plan.joint_positions).all()
            assert one.plan.report.cost == other.plan.report.cost
        else:
            assert type(one.error) is type(other.error)


def test_no_process_is_started_for_a_single_try(hexapod: RobotModel, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: Any, **__: Any) -> None:
        raise AssertionError("a process was started")

    monkeypatch.setattr("gaitforge.pipeline.search.tries.ProcessPoolExecutor", refuse)
    with Workers(4) as workers:
        (result,) = workers.run(tries(hexapod)[:1])
    assert result.plan is not None


def test_no_process_is_started_on_a_machine_that_is_busy(hexapod: RobotModel, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("os.getloadavg", lambda: (64.0, 64.0, 64.0))
    monkeypatch.setattr(Workers, "_submit", lambda self, one: pytest.fail("a process was started"))
    with Workers(2) as workers:
        assert len(workers.run(tries(hexapod)[:2])) == 2
    monkeypatch.setattr("os.getloadavg", lambda: (0.0, 0.0, 0.0))
    monkeypatch.setattr("os.sched_getaffinity", lambda _: {0, 1})
    assert room_for_more()


class Dead:
    """A future of a process that has died."""

    def cancel(self) -> bool:
        return False

    def result(self) -> Result:
        raise BrokenProcessPool("died")


@pytest.mark.usefixtures("idle")
def test_what_a_dead_process_leaves_undone_is_done_here(hexapod: RobotModel, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Workers, "_submit", lambda self, one: Dead())
    with Workers(2) as workers:
        results = workers.run(tries(hexapod)[:2])
    assert results[0].plan is not None
    assert isinstance(results[1].error, InfeasibleMotion)


@pytest.mark.usefixtures("idle")
def test_an_interrupt_waits_for_no_process(hexapod: RobotModel) -> None:
    before, begin = set(active_children()), time.perf_counter()
    started: list[BaseProcess] = []

    def interrupted() -> None:
        with Workers(2) as workers:
            workers._submit(tries(hexapod)[0])
            assert workers._pool is not None
            workers._pool.submit(time.sleep, 60.0)
            started.extend(set(active_children()) - before)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert len(started) == 1
    # not join: the pool's own thread may have asked for the exit code first, and join then knows of none
    assert wait([started[0].sentinel], 20.0)
    assert time.perf_counter() - begin < 40.0


def test_bad_input_is_no_result_but_an_error(hexapod: RobotModel) -> None:
    bad = tries(hexapod)[0]
    with pytest.raises(InputError):
        attempt(replace(bad, named={"roles": {"tail": "held"}}))
