"""Limbs that fail on the way: when, what is left, and how a task goes on."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations, pairwise

import numpy as np
import pytest

from gaitforge.errors import InfeasibleFootfall, UnsolvedError
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion.constraints.locked import Locked
from gaitforge.motion.constraints.off_ground import OffGround
from gaitforge.motion.costs import Smoothness
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import Command, MotionPlan
from gaitforge.motion.solvers.structured import Structured
from gaitforge.pipeline.failure.damage import SPEEDS, Damage, kept_clear, stuck
from gaitforge.pipeline.failure.event import at_speed, moment, refuse_hopeless, stretches
from gaitforge.pipeline.failure.restart import plan_restart
from gaitforge.pipeline.options import Options
from gaitforge.pipeline.schedule import plan_task
from gaitforge.pipeline.search.segment import Segment
from gaitforge.pipeline.search.tries import Workers
from gaitforge.pipeline.stopwatch import Stopwatch
from gaitforge.robot.load import load_robot
from gaitforge.robot.model import RobotModel
from gaitforge.task.load import load_task
from gaitforge.task.phase import Failure, Phase, Task
from gaitforge.task.roles import Failed
from tests.pipeline.test_cascade import plan_of

OPTIONS = Options(simulator=None, recorder=None)  # type: ignore[arg-type]  # planning simulates and records nothing
TRIPOD = {"L1": "000111", "L2": "111000", "L3": "000111", "R1": "111000", "R2": "000111", "R3": "111000"}
DATA = {
    "limbs": ["R3"], "at": 0.5,
    "phases": [{"name": "all", "cycles": 1, "failure": {}, "gait": "tripod"}, {"name": "without", "cycles": 3}],
}  # fmt: skip


@pytest.fixture(scope="module")
def hexapod() -> RobotModel:
    return load_robot("hexapod")


def phases(*failures: Failure | None) -> Task:
    return Task("t", tuple(Phase(f"p{i}", failure=f) for i, f in enumerate(failures)))


def test_a_stretch_ends_where_something_fails() -> None:
    lost = Failure(("L1",))
    assert [list(s) for s in stretches(phases(None, None))] == [[0, 1]]
    assert [list(s) for s in stretches(phases(None, lost, None, None))] == [[0, 1], [2, 3]]
    assert [list(s) for s in stretches(phases(lost, lost, None))] == [[0], [1], [2]]


def test_the_moment_is_drawn_from_the_seed_and_is_another_for_other_limbs(hexapod: RobotModel) -> None:
    gait = plan_of(hexapod, FootfallPattern.from_rows(TRIPOD), "all", 2.0)
    drawn = {
        limbs: [moment(hexapod, gait, Failure(limbs), seed) for seed in range(40)] for limbs in (("L1",), ("L2", "R3"))
    }
    assert drawn["L1",] != drawn["L2", "R3"]
    assert all(set(columns) == set(range(6)) for columns in drawn.values()), "every column is drawn at some time"
    assert drawn["L2", "R3"] == [moment(hexapod, gait, Failure(("R3", "L2")), seed) for seed in range(40)]
    assert [moment(hexapod, gait, Failure(("L1",), at=at), 0) for at in (0.0, 0.5, 0.6, 0.999)] == [0, 3, 3, 5]


def test_a_slower_task_is_slower_in_its_stretch_only(hexapod: RobotModel) -> None:
    task = Task("t", (Phase("a", speed=0.1), Phase("b", speed=0.1), Phase("c")))
    slower = at_speed(task, range(1, 3), 0.5, hexapod)
    assert [p.speed for p in slower.phases] == [0.1, 0.05, 0.5 * hexapod.nominal.speed]
    assert at_speed(task, range(3), 1.0, hexapod) is task


def test_failed_limbs_keep_their_posture_and_are_kept_off_the_ground(hexapod: RobotModel) -> None:
    roles = {"L2": Failed(posture=(0.1, -0.2, 0.3))}
    robot = stuck(hexapod, roles)
    rows = hexapod.joint_indices(hexapod.limb("L2"))
    np.testing.assert_allclose(robot.nominal.held_posture[rows], [0.1, -0.2, 0.3])
    others = np.setdiff1d(np.arange(len(hexapod.joint_names)), rows)
    np.testing.assert_array_equal(robot.nominal.held_posture[others], hexapod.nominal.held_posture[others])
    twice = kept_clear(robot, roles, kept_clear(robot, roles, OPTIONS))
    assert twice.motion is not None
    (family,) = [f for f in twice.motion.constraints if isinstance(f, OffGround)]
    foot = robot.foot_positions(np.zeros(6), robot.nominal.held_posture)[1]
    assert family.points == (("L2", tuple(foot.tolist()), hexapod.limb("L2").foot.radius),)


def test_a_whole_robot_walks_as_fast_as_it_is_told_and_restarts_from_nowhere(hexapod: RobotModel) -> None:
    whole = Damage(hexapod, OPTIONS)
    assert whole.speeds == (1.0,)
    assert replace(whole, roles={"L1": Failed()}).speeds == SPEEDS
    gait = plan_of(hexapod, FootfallPattern.from_rows(TRIPOD), "all", 2.0)
    assert plan_restart(whole, gait, Stopwatch(), Workers()) == []


@pytest.fixture(scope="module")
def planned(hexapod: RobotModel) -> list:
    done: list = []
    plan_task(hexapod, load_task(DATA, "t", robot=hexapod), OPTIONS, Stopwatch(), done)
    return done


@pytest.mark.parametrize("limbs", [["L1", "L2"], ["L1", "R2", "R3"], ["L1", "L2", "R1"]])
def test_a_hexapod_without_two_limbs_of_a_side_or_any_three_is_refused_before_anything_is_planned(
    hexapod: RobotModel, limbs: list[str]
) -> None:
    done: list = []
    with pytest.raises(InfeasibleFootfall) as caught:
        plan_task(hexapod, load_task({**DATA, "limbs": limbs}, "t", robot=hexapod), OPTIONS, Stopwatch(), done)
    assert caught.value.explain["families"]
    assert done == []


def test_what_may_walk_somehow_is_not_refused(hexapod: RobotModel) -> None:
    for limbs in combinations(hexapod.limb_names, 2):
        if limbs[0][0] != limbs[1][0]:
            refuse_hopeless(hexapod, load_task({**DATA, "limbs": list(limbs)}, "t", robot=hexapod), OPTIONS)


def test_a_task_goes_on_after_a_failure_with_the_limbs_that_are_left(hexapod: RobotModel, planned: list) -> None:
    plans = [s.plan for s in planned]
    settle = "all_clear_to_without_start"
    names = ["start", "all", "all_until_failure", "all_halt", "all_clear", settle, "without_start", "without", "stop"]
    assert [p.name for p in plans] == names
    assert [s.cycles for s in planned] == [1, 1, 1, 1, 1, 1, 1, 3, 1]
    rows = hexapod.joint_indices(hexapod.limb("R3"))
    stuck_at = plans[2].joint_positions[rows, -1]
    for plan in plans[3:]:
        found = plan.joint_positions[rows]
        np.testing.assert_allclose(found, np.tile(stuck_at[:, None], found.shape[1]), atol=1e-6, err_msg=plan.name)
        assert plan.roles["R3"] == Failed("locked", tuple(stuck_at.tolist()))
    foot, radius = hexapod.limb_names.index("R3"), hexapod.limb("R3").foot.radius
    for plan in plans[5:]:
        assert plan.feet[:, foot, 2].min() - radius >= 0.01 - 1e-6, plan.name
        assert "R3" not in plan.pattern.locomotive


def test_one_plan_begins_where_the_one_before_ends(hexapod: RobotModel, planned: list) -> None:
    for before, after in pairwise(planned):
        np.testing.assert_allclose(
            after.plan.joint_positions[:, 0], before.plan.joint_positions[:, -1], atol=1e-6, err_msg=after.plan.name
        )
        np.testing.assert_allclose(after.plan.base_poses[0, 2:5], before.plan.base_poses[-1, 2:5], atol=1e-6)


@pytest.mark.parametrize("held", [("R3",), ()])
def test_failed_feet_bear_load_once_more_when_there_are_no_steps_from_the_stand_without_them(
    hexapod: RobotModel, planned: list, monkeypatch: pytest.MonkeyPatch, held: tuple[str, ...]
) -> None:
    plans = {s.plan.name: s.plan for s in planned}
    halt, clear = plans["all_halt"], plans["all_clear"]
    roles = {"R3": plans["without"].roles["R3"]}
    asked: list[tuple[str, tuple[str, ...]]] = []

    def settled(now: Damage, stand: MotionPlan, start: MotionPlan, watch: Stopwatch) -> Segment:
        asked.append((stand.name, now.held))
        if stand is clear:
            raise UnsolvedError("no steps")
        return Segment(replace(stand, name="steps"))

    monkeypatch.setattr("gaitforge.pipeline.failure.restart._settled", settled)
    monkeypatch.setattr("gaitforge.pipeline.failure.restart.plan_stand", lambda *a: plans["without_start"])
    now = Damage(stuck(hexapod, roles), OPTIONS, roles, halt, clear, held)
    four = replace(plans["without"], pattern=replace(plans["without"].pattern, contact=np.zeros((6, 12), dtype=bool)))
    if not held:
        with pytest.raises(UnsolvedError):
            plan_restart(now, four, Stopwatch(), Workers())
        assert asked == [("all_clear", ())]
        return
    segments = plan_restart(now, four, Stopwatch(), Workers())
    assert asked == [("all_clear", ()), ("all_halt", ("R3",))]
    assert [s.plan.name for s in segments] == ["steps", "without_start"], "the stand without them is left out"


def test_many_limbs_step_as_in_a_transition_whose_accelerations_are_dear(
    hexapod: RobotModel, planned: list, monkeypatch: pytest.MonkeyPatch
) -> None:
    plans = {s.plan.name: s.plan for s in planned}
    asked: list[tuple[Options, Command]] = []

    def change(robot: RobotModel, stand: MotionPlan, at_rest: MotionPlan, options: Options, *more: object) -> Segment:
        asked.append((options, at_rest.command))
        return Segment(stand)

    monkeypatch.setattr("gaitforge.pipeline.failure.restart.plan_change", change)
    monkeypatch.setattr("gaitforge.pipeline.failure.restart.plan_stand", lambda *a: plans["without_start"])
    roles = {"R3": plans["without"].roles["R3"]}
    now = Damage(stuck(hexapod, roles), OPTIONS, roles, plans["all_halt"])
    plan_restart(now, replace(plans["all"], name="without"), Stopwatch(), Workers())
    plan_restart(replace(now, held=("R3",)), replace(plans["all"], name="without"), Stopwatch(), Workers())
    (options, command), (held, _) = asked
    assert options.motion is not None
    dear, usual = ([f for f in o.costs if isinstance(f, Smoothness)] for o in (options.motion, MotionOptions()))
    assert dear == [replace(usual[0], position=20.0 * usual[0].position)]
    assert command.speed == 0.0
    assert held.motion is not None
    locked = [[f.limbs for f in o.constraints if isinstance(f, Locked)] for o in (options.motion, held.motion)]
    assert locked == [[], [("R3",)]], "a limb that bears load while it is locked is not to be moved"


def test_many_limbs_give_up_early_where_failed_feet_may_bear_load_and_try_all_they_can_last(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """`plan_change` finds nothing, and notes what it was asked."""
    robot = load_robot("dodecapod")
    pattern = FootfallPattern.from_rows({n: "1" * 11 + "0" for n in robot.limb_names})
    gait, halt, clear = (plan_of(robot, pattern, name, 2.0) for name in ("without", "all_halt", "all_clear"))
    asked: list[tuple[str, int, bool, bool]] = []

    def change(robot: RobotModel, before: MotionPlan, after: MotionPlan, options: Options, *more: object) -> Segment:
        motion = options.motion or MotionOptions()
        fallback = isinstance(motion.solver, Structured) and motion.solver.fallback is not None
        locked = any(isinstance(f, Locked) for f in motion.constraints)
        asked.append((before.name, options.search.transition_candidates, fallback, locked))
        raise UnsolvedError(f"no way {len(asked)}")

    monkeypatch.setattr("gaitforge.pipeline.failure.restart.plan_change", change)
    monkeypatch.setattr("gaitforge.pipeline.failure.restart.plan_stand", lambda *more: gait)
    now = Damage(robot, OPTIONS, {"L1": Failed("locked", (0.0, 0.0, 0.0))}, halt, clear, ("L1",))
    with pytest.raises(UnsolvedError, match="no way 3"):
        plan_restart(now, gait, Stopwatch(), Workers())
    assert asked == [("all_clear", 1, False, False), ("all_halt", 4, True, True), ("all_clear", 4, True, False)]
    asked.clear()
    with pytest.raises(UnsolvedError, match="no way 1"):
        plan_restart(replace(now, held=()), gait, Stopwatch(), Workers())
    assert asked == [("all_clear", 4, True, False)]


def test_a_damaged_robot_may_walk_slower_and_what_was_tried_is_told(
    hexapod: RobotModel, planned: list, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The planner of gaits refuses full speed once a limb is lost; the rest of it is what was planned before."""
    plans = {s.plan.name: s for s in planned}

    def phase(robot: RobotModel, phase: Phase, *more: object) -> object:
        if phase.name == "without" and phase.speed is None:
            raise UnsolvedError("too fast")
        return plans[phase.name]

    monkeypatch.setattr("gaitforge.pipeline.schedule.plan_phase", phase)
    into = [plans[name] for name in ("all_clear", "all_clear_to_without_start", "without_start")]
    monkeypatch.setattr("gaitforge.pipeline.schedule.plan_restart", lambda now, *a: into if now.roles else [])
    done: list = []
    plan_task(hexapod, load_task(DATA, "t", robot=hexapod), OPTIONS, Stopwatch(), done)
    assert [s.plan.name for s in done] == list(plans)
    gait = next(s for s in done if s.plan.name == "without")
    assert [(a.what, a.why) for a in gait.left[:1]] == [("100% of the speed", "too fast")]


def walked_on(*limbs: str, at: float) -> dict[str, Segment]:
    """A dodecapod's segments by name, limbs locked at a share of its cycle."""
    done: list[Segment] = []
    task = Task("t", (Phase("all", failure=Failure(limbs, "locked", at)), Phase("without")))
    plan_task(load_robot("dodecapod"), task, OPTIONS, Stopwatch(), done)
    return {segment.plan.name: segment for segment in done}


def test_a_dodecapod_whose_feet_come_to_stand_3_mm_apart_steps_into_its_gait_at_once() -> None:
    segments = walked_on("L2", "L3", "R1", "R6", at=11 / 12)
    assert segments["without"].plan.command.speed == pytest.approx(load_robot("dodecapod").nominal.speed)
    steps = segments["all_clear_to_without_start"]
    assert steps.left == ()
    assert 0.002 <= steps.plan.report.details["gap_m"] < 0.004


def test_feet_are_not_dragged_while_a_strained_robot_steps() -> None:
    """By 3 mm in the plan they were, until motors gave way: 17 mm of slip in PyBullet."""
    steps = walked_on("L1", "R1", "R3", "R6", at=0.75)["all_clear_to_without_start"].plan
    assert steps.report.details["slip_m"] <= 1e-3
