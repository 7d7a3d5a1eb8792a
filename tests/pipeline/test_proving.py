"""What fails in simulation is refused, and the task is planned again without it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import pytest

import gaitforge as gf
from gaitforge.motion.rotate import rotated
from gaitforge.motion.timeline_build import build_timeline
from gaitforge.pipeline.options import Options, Search
from gaitforge.pipeline.proving import Proven, proven
from gaitforge.pipeline.schedule import plan_task
from gaitforge.pipeline.search.refusals import refused
from gaitforge.pipeline.search.segment import Segment
from gaitforge.pipeline.stopwatch import Stopwatch
from gaitforge.robot.model import RobotModel
from gaitforge.task.load import load_task
from gaitforge.task.phase import Task
from gaitforge.verify.checks import CheckLimits
from gaitforge.verify.checks.limits import SegmentLimits
from gaitforge.verify.mujoco import MujocoSimulator
from gaitforge.verify.verdict import Verdict
from gaitforge.verify.verify import verify_timeline

DATA = {"phases": [
    {"name": "six", "cycles": 1, "gait": "tripod"},
    {"name": "five", "cycles": 1, "gait": "program", "roles": {"R1": {"role": "held"}}},
]}  # fmt: skip
STRICT = CheckLimits(transition=SegmentLimits(slip_mm=0.0))
"""No transition keeps these"""


@dataclass
class Simulation:
    """MuJoCo, and what was put to it."""

    robot: RobotModel
    limits: CheckLimits | None = None
    plans: list[tuple[Segment, ...]] = field(default_factory=list)

    def __call__(self, segments: Sequence[Segment]) -> Verdict:
        self.plans.append(tuple(segments))
        timeline = build_timeline(self.robot, [(s.plan, s.cycles) for s in segments])
        return verify_timeline(self.robot, timeline, simulator=MujocoSimulator(), limits=self.limits)


@dataclass(frozen=True)
class Case:
    robot: RobotModel
    task: Task
    segments: tuple[Segment, ...]


def prove(case: Case, replans: int, limits: CheckLimits | None = STRICT) -> tuple[Proven, Simulation]:
    simulation = Simulation(case.robot, limits)
    found = proven(case.robot, case.task, asked(replans), Stopwatch(), case.segments, simulation)
    return found, simulation


def asked(replans: int) -> Options:
    return Options(simulator=MujocoSimulator(), recorder=None, search=Search(replans=replans))  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def case() -> Case:
    robot = gf.load_robot("hexapod")
    task, done = load_task(DATA, "t", robot=robot), list[Segment]()
    plan_task(robot, task, asked(0), Stopwatch(), done)
    return Case(robot, task, tuple(done))


def named(segments: Sequence[Segment], name: str) -> Segment:
    return next(s for s in segments if s.plan.name == name)


def test_what_holds_is_simulated_once(case: Case) -> None:
    found, simulation = prove(case, replans=2, limits=None)
    assert found.verdict.passed
    assert len(simulation.plans) == len(found.verdicts) == 1
    assert found.segments == case.segments


def test_a_refused_transition_gives_way_to_another_one_and_nothing_else_changes(case: Case) -> None:
    found, simulation = prove(case, replans=1)
    old, new = simulation.plans
    assert len(found.verdicts) == 2
    for name in ("six", "five"):
        np.testing.assert_array_equal(named(old, name).plan.joint_positions, named(new, name).plan.joint_positions)
    one, other = (named(plans, "six_to_five") for plans in simulation.plans)
    assert (one.plan.pattern.contact.tobytes(), one.plan.duration) != (
        other.plan.pattern.contact.tobytes(),
        other.plan.duration,
    )
    assert [a.why for a in other.left if a.why.startswith("refused: slip ")]


def test_of_plans_that_all_fail_the_one_with_the_fewest_failed_checks_is_kept(case: Case) -> None:
    found, simulation = prove(case, replans=2)
    fewest = min(len(v.failed) for v in found.verdicts)
    assert len(found.verdict.failed) == fewest > 0
    assert found.segments == simulation.plans[found.verdicts.index(found.verdict)]


def test_equation_3_is_judged_as_it_is(case: Case) -> None:
    simulation = Simulation(case.robot, STRICT)
    options = replace(asked(2), transition="interpolate")
    found = proven(case.robot, case.task, options, Stopwatch(), case.segments, simulation)
    assert len(found.verdicts) == 1


def test_a_pattern_that_was_asked_for_has_nothing_to_take_its_place(case: Case) -> None:
    strict = CheckLimits(gait=SegmentLimits(slip_mm=0.0))
    told: list[str] = []
    task = replace(case.task, phases=case.task.phases[:1])
    watch = Stopwatch(lambda stage, message: told.append(message))
    done: list[Segment] = []
    plan_task(case.robot, task, asked(0), watch, done)
    found = proven(case.robot, task, asked(2), watch, done, Simulation(case.robot, strict))
    assert len(found.verdicts) == 1
    assert not found.verdict.passed
    assert "nothing to take its place" in told[-1]


def test_a_refused_start_takes_another_time_and_a_refused_stop_another_column(case: Case) -> None:
    found, simulation = prove(case, replans=1, limits=CheckLimits(stand=SegmentLimits(slip_mm=0.0)))
    old, new = ([s.plan for s in plans if s.plan.kind != "gait"] for plans in simulation.plans)
    assert {c.segment for c in found.verdicts[0].failed} == {"start", "stop"}
    assert named(simulation.plans[1], "start").plan.duration == 1.6 * named(simulation.plans[0], "start").plan.duration
    assert [plan.name for plan in old] == ["start", "six_to_five", "stop"]
    assert [plan.name for plan in new] == ["start", "six_to_five", "five_until_stop", "stop"]


def test_halts_and_starts_take_other_times_and_when_nothing_is_left_nothing_is_simulated_again(case: Case) -> None:
    """The stand that lifts a locked foot off the ground is what it is."""
    data = {"limbs": ["R3"], "at": 0.5, "phases": [
        {"name": "all", "cycles": 1, "gait": "tripod", "failure": {}}, {"name": "without", "cycles": 1},
    ]}  # fmt: skip
    task, done, told = load_task(data, "t", robot=case.robot), list[Segment](), list[str]()
    watch = Stopwatch(lambda stage, message: told.append(message))
    plan_task(case.robot, task, asked(0), watch, done)
    simulation = Simulation(case.robot, CheckLimits(stand=SegmentLimits(slip_mm=0.0)))
    found = proven(case.robot, task, asked(9), watch, done, simulation)
    assert any("nothing to take the place of all_clear" in line for line in told)
    halts, starts = ({named(p, name).plan.duration for p in simulation.plans} for name in ("all_halt", "start"))
    assert halts == {1.0, 0.6}
    assert starts == {1.0, 1.6}
    assert len(found.verdicts) == 2, "then the tripod is refused, and no other gait may take its place"


def test_with_a_stand_that_is_refused_again_the_gait_beside_it_is_refused(case: Case) -> None:
    verdict = Simulation(case.robot, CheckLimits(stand=SegmentLimits(slip_mm=0.0)))(case.segments)
    once = refused(verdict, case.segments)
    assert [r.segment for r in once] == ["start", "stop"]
    assert [r.segment for r in refused(verdict, case.segments, once)] == ["start", "six", "five", "stop"]


def test_a_gait_is_the_same_whichever_column_it_begins_with(case: Case) -> None:
    verdict = Simulation(case.robot, CheckLimits(gait=SegmentLimits(slip_mm=0.0)))(case.segments)
    turned = [replace(s, plan=rotated(s.plan, 5)) if s.plan.kind == "gait" else s for s in case.segments]
    assert refused(verdict, turned) == refused(verdict, case.segments) != ()


def test_after_a_fall_no_later_segment_is_refused(case: Case) -> None:
    verdict = Simulation(case.robot, replace(STRICT, fallen_deg=0.0))(case.segments)
    assert {"six", "five"} <= {c.segment for c in verdict.failed if c.name == "fallen"}
    assert [r.segment for r in refused(verdict, case.segments)] == ["start"]


def test_a_dodecapod_whose_steps_fail_in_simulation_takes_others_and_walks_on() -> None:
    robot = gf.load_robot("dodecapod")
    data = {
        "limbs": ["L3", "L4", "R5", "R6"], "at": 11 / 12,
        "phases": [{"name": "all", "cycles": 1, "failure": {}}, {"name": "without", "cycles": 1}],
    }  # fmt: skip
    task, done = load_task(data, "t", robot=robot), list[Segment]()
    options = replace(asked(2), search=Search(gait_batch=1))
    plan_task(robot, task, options, Stopwatch(), done)
    found = proven(robot, task, options, Stopwatch(), done, Simulation(robot))
    assert [v.passed for v in found.verdicts] == [False, True]
    assert found.verdict.passed
