"""Contact is held over intervals: who is on the ground when, how high, and who carries the robot."""

from __future__ import annotations

import numpy as np
import pytest

from gaitforge.motion.dense import check_densely
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import Command, MotionPlan
from gaitforge.motion.trajectory import Discretisation
from gaitforge.robot.model import RobotModel
from tests.motion.motion_kit import CHANGE, PENTA, TRIPOD, feet_in_motion, gait_segment, instance, open_segment

SOLVED = 5e-6
"""[m] what the solver leaves of a bound"""


def ground_by_hand(grid: Discretisation) -> np.ndarray:
    """(K, n_F) on the ground at t_j: C of the interval before, or of the one after, or across an open end."""
    columns, r = grid.pattern.contact, grid.samples_per_column
    ground = np.zeros((grid.samples, len(columns)), dtype=bool)
    for k in range(grid.samples):
        for interval in (k - 1, k):
            if grid.cyclic:
                interval %= grid.intervals
            if 0 <= interval < grid.intervals:
                ground[k] |= columns[:, interval // r]
    for k, end in ((0, grid.start), (grid.samples - 1, grid.end)):
        if end is not None:
            ground[k] |= end.ground
    return ground


def rise_by_hand(ground: np.ndarray, k: int, r: int, cyclic: bool) -> tuple[float, bool]:
    """How much of the step height a foot in the air has to have at sample k, and whether it may not have much more.

    It has two columns to rise in, less in a short swing (half of it), never less than one; in the
    first interval of a rise that takes more than a column it stays low.
    """
    count = len(ground)
    at = (lambda j: ground[j % count]) if cyclic else (lambda j: 0 <= j < count and ground[j])
    since = next((n for n in range(1, count) if at(k - n)), None)
    until = next((n for n in range(1, count) if at(k + n)), None)
    if since is None and until is None:
        return 1.0, False
    if since is not None and until is not None:
        room = 0.5 * (since + until)
    else:  # all that there is on this side of the seam
        room = k + until if since is None else count - 1 - (k - since)
    rise = max(r, min(2.0 * r, room))
    away = min(n for n in (since, until) if n is not None)
    share = min(1.0, away / rise)
    return share**3 * (10 - 15 * share + 6 * share**2), away == 1 and rise > r


@pytest.mark.parametrize("r", [1, 2, 3])
def test_a_foot_is_on_the_ground_when_it_stands_before_or_after(hexapod: RobotModel, r: int) -> None:
    for segment in (
        gait_segment(hexapod, PENTA, Command(0.06), r),
        open_segment(hexapod, CHANGE, "transition", r),
        open_segment(hexapod, CHANGE, "stand", r, resting=(True, False)),
    ):
        assert (segment.grid.ground == ground_by_hand(segment.grid)).all()


def test_at_a_tripod_switch_all_six_feet_are_on_the_ground(hexapod: RobotModel) -> None:
    grid = gait_segment(hexapod, TRIPOD, Command(0.06), r=2).grid
    assert grid.ground[[0, 12]].all()
    assert grid.ground[[1, 11, 13, 23]].sum(axis=1).tolist() == [3, 3, 3, 3]


@pytest.mark.parametrize("r", [1, 2, 4])
def test_swinging_feet_have_to_rise_with_the_samples_to_the_ground(hexapod: RobotModel, r: int) -> None:
    """σ over the intervals that a foot has to rise in; low in the first of them where there are many."""
    for segment in (gait_segment(hexapod, PENTA, Command(0.06), r), open_segment(hexapod, CHANGE, "transition", r)):
        case = instance(segment)
        grid, (low, high) = segment.grid, case.problem.bounds
        ground, step = ground_by_hand(grid), hexapod.nominal.step_height
        for i in case.trajectory.moving:
            radius = hexapod.limbs[i].foot.radius
            for k in range(grid.samples):
                bounds = low[case.trajectory.feet[i][k, 2]], high[case.trajectory.feet[i][k, 2]]
                if not grid.cyclic and k in (0, grid.samples - 1):
                    assert bounds == (-np.inf, np.inf), "the neighbours fix the pose at a seam"
                elif ground[k, i]:
                    assert bounds == (pytest.approx(radius), pytest.approx(radius))
                else:
                    share, slow = rise_by_hand(ground[:, i], k, r, grid.cyclic)
                    least = radius + step * share
                    assert bounds == (pytest.approx(least), pytest.approx(least + 0.1 * step) if slow else np.inf)


def test_where_contacts_change_there_are_two_sets_of_weights(hexapod: RobotModel) -> None:
    for segment in (gait_segment(hexapod, PENTA, Command(0.06), 2), open_segment(hexapod, CHANGE, "transition", 2)):
        case, grid = instance(segment), segment.grid
        found: dict[int, set[tuple[int, ...]]] = {}
        for k, feet, index in case.trajectory.weights:
            assert len(index) == len(feet)
            assert feet not in found.setdefault(k, set())
            found[k].add(feet)
        for k in range(grid.samples):
            intervals = [k - 1, k]
            if grid.cyclic:
                intervals = [j % grid.intervals for j in intervals]
            inside = [j for j in intervals if 0 <= j < grid.intervals]
            assert found[k] == {tuple(np.flatnonzero(grid.contact[j])) for j in inside}


def test_weights_are_at_least_the_stability_share_of_an_equal_one(hexapod: RobotModel) -> None:
    case = instance(gait_segment(hexapod, PENTA, Command(0.06)), MotionOptions(stability_share=0.35))
    low, high = case.problem.bounds
    for _, feet, index in case.trajectory.weights:
        assert low[index] == pytest.approx(np.full(len(feet), 0.35 / len(feet)))
        assert np.isinf(high[index]).all()


def test_feet_stand_on_the_ground_and_swing_above_it_in_a_solved_plan(plan: MotionPlan, robot_of) -> None:
    """By Pinocchio's frames at the samples, the bound written out."""
    robot, r = robot_of(plan), plan.samples_per_column
    centres, _ = feet_in_motion(robot, plan, plan.times)
    low = 0.3 if plan.kind == "stand" else 1.0  # a stand lifts its feet by less
    contact = np.repeat(plan.pattern.contact, r, axis=1)
    count = len(plan.times)
    for i, limb in enumerate(robot.limbs):
        if not contact[i].any():
            continue
        ground = np.zeros(count, dtype=bool)
        ground[:-1] |= contact[i]
        ground[1:] |= contact[i]
        if plan.kind == "gait":
            ground[[0, -1]] |= contact[i, 0] | contact[i, -1]
        seam = range(1, count - 1) if plan.kind != "gait" else range(count)
        for k in seam:
            height = centres[k, i, 2] - limb.foot.radius
            if ground[k]:
                assert abs(height) < SOLVED
            elif plan.kind == "gait":
                share, _ = rise_by_hand(ground[:-1], k, r, cyclic=True)
                assert height > low * robot.nominal.step_height * share - SOLVED
            else:
                assert height > -SOLVED, "a step that goes on beyond the seam may be lower there"


def test_splines_do_not_push_feet_into_the_ground(request: pytest.FixtureRequest, robot_of) -> None:
    for name in ("tripod", "wave", "change", "start", "stop"):
        plan = request.getfixturevalue(name)
        centres, _ = feet_in_motion(robot_of(plan), plan, np.linspace(0.0, plan.duration, 801))
        walking = plan.pattern.contact.any(axis=1)
        radius = np.array([limb.foot.radius for limb in robot_of(plan).limbs])
        lowest = float((centres[..., 2] - radius)[:, walking].min())
        few = plan.kind == "transition" and plan.pattern.contact.sum(axis=0).min() <= 4
        bound = MotionOptions().change_tolerance if few else MotionOptions().ground_tolerance
        assert lowest > -bound - 1e-4, name
        report = check_densely(robot_of(plan), plan, 0.0, per_interval=16)
        assert report.penetration == pytest.approx(max(0.0, -lowest), abs=2e-5)
