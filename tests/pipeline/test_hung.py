"""Limp limbs out of the way: the whole of a walk that loses one, and what is left as it lies."""

from dataclasses import replace

import pytest

import gaitforge as gf
from gaitforge.motion.constraints.off_ground import OffGround
from gaitforge.motion.failure.fold import fold_groups
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import MotionPlan
from gaitforge.pipeline.failure.damage import stuck
from gaitforge.pipeline.failure.hung import hang_up
from gaitforge.pipeline.failure.over_limp import CLEARANCE_M, STILL_M, spaced
from gaitforge.pipeline.options import Options, Search
from gaitforge.pipeline.schedule import plan_task
from gaitforge.pipeline.search.refusals import refused
from gaitforge.pipeline.search.segment import Segment
from gaitforge.pipeline.stopwatch import Stopwatch
from gaitforge.robot.model import RobotModel
from gaitforge.task.phase import Failure, Phase, Task
from gaitforge.task.roles import Failed
from gaitforge.verify.checks import CheckLimits
from gaitforge.verify.checks.limits import SegmentLimits
from gaitforge.verify.mujoco import MujocoSimulator
from gaitforge.verify.verdict import Verdict
from tests.motion.test_folds import standing

TASK = Task(
    "limb_failure",
    (Phase("all", cycles=1, failure=Failure(("L2",), "limp", 0.25)), Phase("without", cycles=3)),
)


@pytest.fixture(scope="module")
def hexapod() -> RobotModel:
    return gf.load_robot("hexapod")


@pytest.fixture(scope="module")
def options() -> Options:
    return Options(simulator=MujocoSimulator(), recorder=None, search=Search(gait_batch=1))  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def walk(hexapod: RobotModel, options: Options) -> list[Segment]:
    done: list[Segment] = []
    plan_task(hexapod, TASK, options, Stopwatch(), done)
    return done


def test_a_limp_limb_is_folded_before_the_robot_walks_on_higher(walk: list[Segment]) -> None:
    names = [segment.plan.name for segment in walk]
    assert names[3:] == [
        "all_halt", "all_fold_down", "all_fold_up", "all_fold_up_to_without_start", "without_start", "without", "stop",
    ]  # fmt: skip
    plans = {segment.plan.name: segment.plan for segment in walk}
    assert plans["without"].base_poses[:, 2].min() > plans["all"].base_poses[:, 2].max() + 0.03
    assert all(plan.limp == ("L2",) for name, plan in plans.items() if "without" in name or "fold" in name)


def test_a_walk_without_a_limp_limb_is_verified(hexapod: RobotModel, walk: list[Segment]) -> None:
    verdict = gf.verify(hexapod, [(s.plan, s.cycles) for s in walk], simulator="mujoco")
    assert [(check.segment, check.name, check.value) for check in verdict.failed] == []
    rows = hexapod.joint_indices(hexapod.limb("L2"))
    assert verdict.trace.joint_positions[-1, rows[2]] < -0.3, "still bent"


@pytest.fixture(scope="module")
def crouched(hexapod: RobotModel, walk: list[Segment]) -> Verdict:
    """The way down has failed, and nothing else."""
    strict = CheckLimits(stand=SegmentLimits(slip_mm=0.0))
    verdict = gf.verify(hexapod, [(s.plan, s.cycles) for s in walk], simulator="mujoco", limits=strict)
    return replace(verdict, checks=tuple(c for c in verdict.checks if c.segment == "all_fold_down"))


def test_a_way_down_that_fails_is_refused_without_the_way_up(walk: list[Segment], crouched: Verdict) -> None:
    assert [r.segment for r in refused(crouched, walk)] == ["all_fold_down"]


def test_with_a_stand_that_is_refused_again_the_steps_that_led_to_it_are_refused(
    walk: list[Segment], crouched: Verdict
) -> None:
    plans = {segment.plan.name: segment for segment in walk}
    steps, down, up = (plans[f"all_fold_{name}"] for name in ("up_to_without_start", "down", "up"))
    once = refused(crouched, walk)
    assert [r.segment for r in refused(crouched, (plans["all_halt"], steps, up, down), once)] == [
        "all_fold_up_to_without_start", "all_fold_down",
    ]  # fmt: skip
    assert refused(crouched, (plans["all_halt"], up, down), once) == once


def test_a_crouch_that_simulation_refuses_is_made_again_slower_and_less_deep(
    hexapod: RobotModel, options: Options, walk: list[Segment], crouched: Verdict
) -> None:
    crouches = refused(crouched, walk)
    again: list[Segment] = []
    plan_task(hexapod, TASK, replace(options, refused=crouches), Stopwatch(), again)

    def crouch(segments: list[Segment]) -> tuple[float, float]:
        plan = next(s.plan for s in segments if s.plan.name == "all_fold_down")
        return plan.base_poses[-1, 2], plan.duration

    (low, quick), (high, slow) = crouch(walk), crouch(again)
    assert high > low + 0.01
    assert slow > quick


def test_gaits_over_limp_limbs_push_their_feet_into_the_ground_less_than_others(walk: list[Segment]) -> None:
    plans = {segment.plan.name: segment.plan for segment in walk}
    deep = {name: plans[name].report.details["penetration_m"] for name in ("all", "without")}
    assert deep["without"] <= STILL_M < deep["all"]


def hang(robot: RobotModel, options: Options, modes: dict[str, str]) -> tuple[tuple[MotionPlan, bool], list[Segment]]:
    stand = standing(robot, tuple(modes))
    postures = {n: tuple(robot.nominal.posture[robot.joint_indices(robot.limb(n))].tolist()) for n in modes}
    failed = {n: Failed("limp" if mode == "limp" else "locked", postures[n]) for n, mode in modes.items()}
    done: list[Segment] = []
    _, _, last, hung = hang_up(robot, stand, failed, failed, options, Stopwatch(), done)
    return (last, hung), done


def test_a_limp_limb_beside_a_locked_one_stays_where_it_lies(hexapod: RobotModel, options: Options) -> None:
    (last, hung), done = hang(hexapod, options, {"L2": "limp", "R3": "locked"})
    assert not hung
    assert last.name == "stand"
    assert done == []


def test_limbs_that_friction_would_hold_up_stay_where_they_lie(hexapod: RobotModel, options: Options) -> None:
    stiff = replace(options, search=replace(options.search, limp_friction=5.0))
    (last, hung), done = hang(hexapod, stiff, {"L2": "limp"})
    assert (last.name, hung, done) == ("stand", False, [])


def test_limbs_that_the_body_comes_over_are_folded_first_side_by_side(hexapod: RobotModel) -> None:
    limbs = ("L1", "L3", "R1", "R2")
    assert fold_groups(hexapod, standing(hexapod, limbs), limbs, 0.2) == (("L1",), ("R1",), ("L3", "R2"))


def test_a_limb_too_long_to_hang_clear_is_lifted_by_the_gait(hexapod: RobotModel, options: Options) -> None:
    def lifted(name: str, posture: tuple[float, ...]) -> list[str]:
        roles = {name: Failed("limp", posture)}
        motion = spaced(stuck(hexapod, roles), options, roles).motion
        assert isinstance(motion, MotionOptions)
        assert motion.clearance == CLEARANCE_M
        return [p[0] for f in motion.constraints if isinstance(f, OffGround) for p in f.points]

    assert set(lifted("L1", (0.0, -0.85, -1.22))) == {"L1"}
    assert lifted("L2", (0.0, 1.5, -1.0)) == []
