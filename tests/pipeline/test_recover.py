"""Limbs lost while walking: two plans that fit together, the first that will do or the cheapest."""

from __future__ import annotations

import pytest

import gaitforge as gf
from gaitforge.errors import InfeasibleFootfall, InputError
from gaitforge.footfall.constraints import with_problem_families
from gaitforge.footfall.from_robot import gait_problem, transition_problem
from gaitforge.footfall.model import check_pattern
from gaitforge.footfall.quick import pattern_without, quick_transition_pattern
from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.solvers.structured import Structured
from gaitforge.robot.model import RobotModel

FAST = gf.MotionOptions(solver=Structured())


@pytest.fixture(scope="module")
def robot() -> RobotModel:
    return gf.load_robot("dodecapod")


@pytest.fixture(scope="module")
def gait(robot: RobotModel) -> MotionPlan:
    return gf.plan_gait(robot, gf.synthesize_gait_pattern(robot), name="all", options=FAST)


@pytest.fixture(scope="module")
def recovery(robot: RobotModel, gait: MotionPlan) -> gf.Recovery:
    return gf.recover(robot, gait, ["R4"], leave=3)


def test_the_limb_walks_no_more_and_every_other_one_does(robot: RobotModel, recovery: gf.Recovery) -> None:
    assert set(recovery.gait.pattern.locomotive) == set(robot.limb_names) - {"R4"}
    assert recovery.gait.roles == {"R4": gf.Held()}
    assert recovery.gait.pattern.info["operation"] == "original"


def test_the_transition_leaves_the_running_gait_where_asked_and_enters_the_next(
    gait: MotionPlan, recovery: gf.Recovery
) -> None:
    """Positions and velocities go on, by differences of the splines."""
    move, after, h = recovery.transition, recovery.gait, 1e-6
    left = 3 * gait.duration / gait.pattern.columns
    assert move(0.0) == pytest.approx(gait(left), abs=1e-9)
    assert (move(h) - move(0.0)) / h == pytest.approx((gait(left + h) - gait(left)) / h, abs=1e-3)
    assert move(move.duration) == pytest.approx(after(0.0), abs=1e-9)
    assert (move(move.duration) - move(move.duration - h)) / h == pytest.approx((after(h) - after(0)) / h, abs=1e-3)


def test_both_plans_are_checked_between_samples(recovery: gf.Recovery) -> None:
    for plan in (recovery.gait, recovery.transition):
        details = plan.report.details
        assert details["penetration_m"] <= FAST.ground_tolerance
        assert details["speed_ratio"] <= FAST.speed_share
        assert details["zmp_margin_m"] > 0.01
        assert plan.relaxed == ()


def test_the_time_of_every_stage_is_told(recovery: gf.Recovery) -> None:
    assert set(recovery.seconds) == {"gait_pattern", "gait", "transition_pattern", "transition", "total"}
    assert sum(v for k, v in recovery.seconds.items() if k != "total") <= recovery.seconds["total"]


def test_the_cheapest_of_all_candidates_is_no_dearer_than_the_first(robot: RobotModel, gait: MotionPlan) -> None:
    hexapod = gf.load_robot("hexapod")
    six = gf.plan_gait(hexapod, gf.synthesize_gait_pattern(hexapod), name="six", options=FAST)
    first, best = (gf.recover(hexapod, six, ["R1"], policy=policy) for policy in ("first", "best"))  # type: ignore[arg-type]
    for one, other in ((best.gait, first.gait), (best.transition, first.transition)):
        assert len(one.relaxed) <= len(other.relaxed)
    assert best.left
    if not first.gait.relaxed and not best.gait.relaxed:
        assert best.gait.report.cost <= first.gait.report.cost * (1 + 1e-6)


def test_a_limb_that_is_locked_cannot_be_lifted_by_a_transition(robot: RobotModel, gait: MotionPlan) -> None:
    with pytest.raises(InputError, match="limb_failure"):
        gf.recover(robot, gait, ["R4"], roles={"R4": gf.Failed()})


def test_a_pattern_without_the_limb_satisfies_every_family_or_is_none(robot: RobotModel, gait: MotionPlan) -> None:
    for lost in (["R4"], ["L1", "R6"], ["L1", "L2", "L3", "L4"], ["L1", "L3", "L5", "R2", "R4", "R6"]):
        found = pattern_without(robot, gait.pattern, lost)
        if found is None:
            continue
        problem = gait_problem(robot, found.locomotive, found.columns)
        assert not check_pattern(found.contact, problem, with_problem_families(None))
        assert not any(found.row(name).any() for name in lost)
    assert pattern_without(robot, gait.pattern, ["R4"]) is not None
    assert pattern_without(robot, gait.pattern, ["L1", "L3", "L5", "R2", "R4", "R6"]) is None


def test_the_quick_transition_pattern_is_optimal_and_allowed(robot: RobotModel, recovery: gf.Recovery) -> None:
    after = recovery.gait.pattern
    gait = gf.synthesize_gait_pattern(robot)
    found = quick_transition_pattern(robot, gait, after, columns=11)
    slow = gf.synthesize_transition_pattern(robot, gait, after, columns=11)
    assert found.changes <= slow.changes
    problem = transition_problem(robot, gait, after, 11)
    assert not check_pattern(found.contact, problem, with_problem_families(None))


@pytest.mark.parametrize("lost", [[], ["L9"]])
def test_limbs_that_do_not_exist_or_none_at_all_are_refused(
    robot: RobotModel, gait: MotionPlan, lost: list[str]
) -> None:
    with pytest.raises(InputError):
        gf.recover(robot, gait, lost)


def test_a_limb_that_does_not_walk_cannot_be_lost_again(robot: RobotModel, recovery: gf.Recovery) -> None:
    with pytest.raises(InputError, match="R4"):
        gf.recover(robot, recovery.gait, ["R4"])


def test_too_few_limbs_end_with_the_proof_of_the_pattern(robot: RobotModel, gait: MotionPlan) -> None:
    with pytest.raises(InfeasibleFootfall):
        gf.recover(robot, gait, [n for n in robot.limb_names if n not in ("L1", "R1", "L6")])
