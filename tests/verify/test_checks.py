"""Every check on traces that are perfect but for one thing."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from walkers import perfect_trace, stand_plan, timeline_of, tripod_plan, walker

from gaitforge.motion.timeline import Timeline
from gaitforge.verify.checks import ALL, CheckLimits, SegmentLimits
from gaitforge.verify.trace import Trace, UnplannedContact
from gaitforge.verify.verdict import Check
from gaitforge.verify.verify import judge

ROBOT = walker(3)
GAIT = timeline_of(ROBOT, (tripod_plan(ROBOT), 4))
STAND = timeline_of(ROBOT, (stand_plan(ROBOT, 1.0, advance=0.03), 1))
PERFECT = {id(t): perfect_trace(ROBOT, t) for t in (GAIT, STAND)}
Change = Callable[[Trace], dict[str, object]]


def checks(
    timeline: Timeline, change: Change = lambda trace: {}, limits: CheckLimits | None = None
) -> dict[str, Check]:
    trace = PERFECT[id(timeline)]
    found = judge(ROBOT, timeline, replace(trace, **change(trace)), "by hand", limits).checks  # type: ignore[arg-type]
    return {check.name: check for check in found}


def base(change: Callable[[np.ndarray, np.ndarray], None]) -> Change:
    def changed(trace: Trace) -> dict[str, object]:
        poses = trace.base_poses.copy()
        change(poses, trace.times)
        return {"base_poses": poses}

    return changed


def faster(factor: float) -> Change:
    return base(lambda poses, times: poses.__setitem__((slice(None), 0), factor * poses[:, 0]))


def added(column: int, value: Callable[[np.ndarray], np.ndarray]) -> Change:
    return base(lambda poses, times: poses.__setitem__((slice(None), column), poses[:, column] + value(times)))


def failed(found: dict[str, Check]) -> set[str]:
    return {name for name, check in found.items() if not check.passed}


@pytest.mark.parametrize("timeline", [GAIT, STAND])
def test_a_perfect_run_passes_everything(timeline: Timeline) -> None:
    assert failed(checks(timeline)) == set()


@pytest.mark.parametrize(("factor", "good"), [(0.94, False), (0.96, True), (1.04, True), (1.06, False)])
def test_a_gait_may_be_five_percent_slower_or_faster(factor: float, good: bool) -> None:
    found = checks(GAIT, faster(factor))
    assert found["speed"].passed is good
    assert found["speed"].value == pytest.approx(100 * abs(1 - factor))


@pytest.mark.parametrize(("factor", "good"), [(0.90, False), (0.94, True), (1.5, True)])
def test_a_short_stand_may_miss_two_millimetres_and_be_as_fast_as_it_likes(factor: float, good: bool) -> None:
    found = checks(STAND, faster(factor))  # 30 mm
    assert found["speed"].passed is good
    assert found["speed"].unit == "mm"


def test_the_speed_of_each_entry_is_measured_along_the_planned_direction_without_the_first_cycle() -> None:
    def late_start(trace: Trace) -> dict[str, object]:
        poses = trace.base_poses.copy()
        poses[trace.times < 2.0, 0] = 0.0
        return {"base_poses": poses}

    trace = PERFECT[id(GAIT)]
    verdict = judge(ROBOT, GAIT, replace(trace, **late_start(trace)), "by hand")  # type: ignore[arg-type]
    assert verdict.speeds[0] == pytest.approx(0.06)


def test_walking_sideways_is_no_speed_but_drift() -> None:
    found = checks(GAIT, base(lambda poses, times: poses.__setitem__((slice(None), 1), poses[:, 0])))
    assert found["speed"].passed
    assert found["lateral_drift"].value == pytest.approx(3 * 120.0, rel=1e-6)


def test_a_robot_that_was_handed_a_wrong_heading_is_measured_in_its_own() -> None:
    def turned(poses: np.ndarray, times: np.ndarray) -> None:
        poses[:, 5] += np.pi / 2
        poses[:, 1], poses[:, 0] = poses[:, 0].copy(), 0.0

    found = checks(GAIT, base(turned))
    assert found["speed"].value == pytest.approx(0.0, abs=1e-9)
    assert found["heading"].passed


@pytest.mark.parametrize(("deg_per_m", "good"), [(1.9, True), (2.1, False)])
def test_a_gait_may_turn_two_degrees_a_metre(deg_per_m: float, good: bool) -> None:
    found = checks(GAIT, added(5, lambda t: np.radians(deg_per_m) * 0.06 * t))
    assert found["heading"].value == pytest.approx(deg_per_m)
    assert found["heading"].passed is good


def test_a_gait_of_less_than_a_quarter_metre_is_not_judged_by_its_heading() -> None:
    short = timeline_of(ROBOT, (tripod_plan(ROBOT), 2))
    PERFECT[id(short)] = perfect_trace(ROBOT, short)
    found = checks(short, added(5, lambda t: np.radians(1.0) * t))
    assert found["heading"].limit is None
    assert found["heading"].passed


@pytest.mark.parametrize(("deg", "good"), [(2.9, True), (3.1, False)])
def test_a_stand_may_turn_three_degrees(deg: float, good: bool) -> None:
    assert checks(STAND, added(5, lambda t: np.radians(deg) * t))["heading"].passed is good


@pytest.mark.parametrize(
    ("timeline", "deg", "good"), [(GAIT, 1.9, True), (GAIT, 2.1, False), (STAND, 3.9, True), (STAND, 4.1, False)]
)
@pytest.mark.parametrize("axis", [3, 4])
def test_tilt_against_plan_has_a_limit_in_roll_and_pitch(timeline: Timeline, deg: float, good: bool, axis: int) -> None:
    found = checks(timeline, added(axis, lambda t: np.where((t > 0.9) & (t < 1.1) | (t > 5), np.radians(deg), 0.0)))
    assert found["tilt"].value == pytest.approx(deg)
    assert found["tilt"].passed is good


def test_yaw_is_no_tilt() -> None:
    assert checks(GAIT, added(5, lambda t: np.full(len(t), 1.0)))["tilt"].value == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("timeline", "mm", "good"), [(GAIT, 9, True), (GAIT, -11, False), (STAND, -19, True), (STAND, 21, False)]
)
def test_body_height_has_a_limit_up_and_down(timeline: Timeline, mm: float, good: bool) -> None:
    found = checks(timeline, added(2, lambda t: np.full(len(t), mm / 1000)))
    assert found["body_height"].value == pytest.approx(abs(mm))
    assert found["body_height"].passed is good


def test_the_first_cycle_of_a_gait_is_not_judged_by_tilt_but_a_fall_in_it_is_seen() -> None:
    found = checks(GAIT, added(3, lambda t: np.where(t < 1.0, np.radians(25.0), 0.0)))
    assert found["tilt"].passed
    assert not found["fallen"].passed


@pytest.mark.parametrize(("deg", "good"), [(19.0, True), (21.0, False)])
def test_more_than_twenty_degrees_is_a_fall(deg: float, good: bool) -> None:
    assert checks(STAND, added(4, lambda t: np.full(len(t), np.radians(deg))))["fallen"].passed is good


def event(kind: str, time: float = 3.0) -> Change:
    contact = UnplannedContact(time, "something", 5.0, time + 0.01, kind)  # type: ignore[arg-type]
    return lambda trace: {"unplanned": (contact,)}


def test_the_trunk_on_the_ground_is_a_fall_and_a_shin_is_not() -> None:
    assert failed(checks(GAIT, event("trunk"))) == {"fallen", "unplanned_contact"}
    assert failed(checks(GAIT, event("ground"))) == {"unplanned_contact"}


def test_an_unplanned_contact_belongs_to_the_segment_in_which_it_is() -> None:
    both = timeline_of(ROBOT, (stand_plan(ROBOT, 1.0), 1), (tripod_plan(ROBOT), 2))
    trace = replace(perfect_trace(ROBOT, both), **event("self")(PERFECT[id(GAIT)]))  # type: ignore[arg-type]
    found = judge(ROBOT, both, trace, "by hand").checks
    assert {c.segment: c.value for c in found if c.name == "unplanned_contact"} == {"stand": 0, "gait": 1}


@pytest.mark.parametrize(
    ("timeline", "mm", "good"), [(GAIT, 4.9, True), (GAIT, 5.1, False), (STAND, 9.9, True), (STAND, 10.1, False)]
)
def test_slip_is_judged_per_stance(timeline: Timeline, mm: float, good: bool) -> None:
    stance_s = 1.0  # of either timeline

    def sliding(trace: Trace) -> dict[str, object]:
        speed = np.zeros_like(trace.slip_speed)
        speed[:, 2] = np.where(trace.plan.contact[:, 2], mm / 1000 / stance_s, 0.0)
        return {"slip_speed": speed}

    found = checks(timeline, sliding)
    assert found["slip"].value == pytest.approx(mm, rel=0.01)
    assert found["slip"].passed is good


def lifted(foot: int, start: float, end: float) -> Change:
    def changed(trace: Trace) -> dict[str, object]:
        force = trace.normal_force.copy()
        force[(trace.times >= start) & (trace.times < end), foot] = 0.0
        return {"normal_force": force}

    return changed


def test_a_stance_foot_that_is_lost_for_long_leaves_the_mass_outside_and_a_short_hop_does_not() -> None:
    middle = 5.0 if PERFECT[id(GAIT)].plan.contact[5 * 240 + 60, 1] else 4.0
    assert checks(GAIT)["static_margin"].value > 10.0
    assert not checks(GAIT, lifted(1, middle + 0.3, middle + 0.7))["static_margin"].passed
    assert checks(GAIT, lifted(1, middle + 0.45, middle + 0.5))["static_margin"].passed


def test_agreement_is_the_share_of_feet_and_times_that_are_as_planned() -> None:
    assert checks(STAND)["contact_agreement"].value == 100.0
    found = checks(STAND, lifted(0, 0.0, 0.5))
    assert found["contact_agreement"].value == pytest.approx(100 * (1 - 0.5 / 6), abs=0.1)
    assert found["contact_agreement"].limit is None


def test_effort_and_speed_are_told_as_shares_of_the_limits_and_one_step_is_no_peak() -> None:
    def pushed(rows: slice) -> Change:
        def changed(trace: Trace) -> dict[str, object]:
            torque = np.zeros_like(trace.joint_torques)
            torque[rows, 4] = 3.5
            return {"joint_torques": torque}

        return changed

    assert checks(STAND, pushed(slice(100, 150)))["effort_ratio"].value == pytest.approx(0.5)
    assert checks(STAND, pushed(slice(100, 101)))["effort_ratio"].value == pytest.approx(0.5 / 6)


def test_cost_of_transport_is_work_over_weight_and_distance() -> None:
    def working(trace: Trace) -> dict[str, object]:
        torque, speed = np.zeros_like(trace.joint_torques), np.zeros_like(trace.joint_torques)
        torque[:, 0], speed[:, 0] = 2.0, -0.5  # 1 W, braking
        return {"joint_torques": torque, "joint_velocities": speed}

    found = checks(GAIT, working)["cost_of_transport"]
    assert found.value == pytest.approx(6.0 / (ROBOT.mass * 9.81 * 0.36), rel=1e-3)  # three cycles


def test_joint_tracking_is_the_root_of_the_mean_square() -> None:
    found = checks(STAND, lambda trace: {"joint_positions": trace.joint_positions + np.radians(0.5)})
    assert found["joint_tracking"].value == pytest.approx(0.5)


def test_limits_can_be_set() -> None:
    strict = CheckLimits(gait=SegmentLimits(speed_percent=3.0))
    assert checks(GAIT, faster(0.96))["speed"].passed
    assert not checks(GAIT, faster(0.96), limits=strict)["speed"].passed


def test_every_check_has_its_own_name_and_a_title() -> None:
    assert len({check.name for check in ALL}) == len(ALL)
    assert all(check.title for check in ALL)
