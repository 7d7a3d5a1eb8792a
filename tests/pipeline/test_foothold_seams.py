"""Where gaits are joined: feet that are really there, and an order of steps in which none is in another's way."""

from __future__ import annotations

import numpy as np
import pytest

import gaitforge as gf
from gaitforge.errors import InfeasibleFootfall
from gaitforge.footfall.constraints.g08_stance_count import StanceCount
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion.plan import MotionPlan
from gaitforge.pipeline.search.seams import MOST_COLUMNS, Ends, foot_paths, meetings, nearest, order, turning_points
from gaitforge.robot.model import RobotModel


def transition(*rows: str) -> FootfallPattern:
    """One row a limb, 1 stance."""
    contact = np.array([[c == "1" for c in row] for row in rows])
    return FootfallPattern(contact, tuple(f"L{i + 1}" for i in range(len(rows))), False, "given")


def ends(start: list[list[float]], end: list[list[float]]) -> Ends:
    before, after = np.array(start), np.array(end)
    return Ends((before, after), (before.mean(axis=0), after.mean(axis=0)))


def test_a_foot_stands_at_its_old_place_until_it_lifts_and_at_its_new_one_from_when_it_lands() -> None:
    paths = foot_paths(transition("1100011"), ends([[0.0, 0.2]], [[0.3, 0.2]]))
    np.testing.assert_allclose(paths[0, :, 0], [0.0, 0.0, 0.05, 0.15, 0.25, 0.3, 0.3])
    np.testing.assert_allclose(paths[0, :, 1], 0.2)


def test_between_two_steps_a_foot_stands_half_way_and_without_one_it_stays() -> None:
    paths = foot_paths(transition("010110", "111111"), ends([[0.0, 0.2], [0.5, 0.2]], [[0.4, 0.2], [0.5, 0.2]]))
    np.testing.assert_allclose(paths[0, :, 0], [2 / 30 * 1.0, 0.4 / 3, 0.2, 0.8 / 3, 0.8 / 3, 1.0 / 3], atol=1e-12)
    np.testing.assert_allclose(paths[1, :, 0], 0.5)


def test_the_nearest_feet_are_found_as_a_loop_over_all_pairs_finds_them() -> None:
    paths = np.random.default_rng(3).normal(size=(5, 7, 2))
    loop = min(
        float(np.hypot(*(paths[i, j] - paths[k, j]))) for j in range(7) for i in range(5) for k in range(5) if i != k
    )
    assert nearest(paths) == pytest.approx(loop)


def test_the_foot_ahead_makes_room_before_the_one_behind_comes() -> None:
    start = [[0.0, 0.2], [-0.15, 0.2], [0.0, -0.2], [-0.15, -0.2]]
    moved = [[0.15, 0.2], [0.0, 0.2], [0.15, -0.2], [0.0, -0.2]]
    makes_room = transition("1001111111", "1111001111", "1111111111", "1111111111")
    in_the_way = transition("1111001111", "1001111111", "1111111111", "1111111111")
    places = ends(start, [*moved[:2], *start[2:]])
    assert nearest(foot_paths(in_the_way, places)) < 1e-9
    assert nearest(foot_paths(makes_room, places)) == pytest.approx(0.15)
    assert order(makes_room, places, 0.03) < order(in_the_way, places, 0.03)


def test_a_step_in_a_hurry_is_better_than_a_switch_at_which_the_robot_tips() -> None:
    """Front limbs lift as rear ones land: no place of the body is inside both; a quick step leaves it one."""
    start = [[0.3, 0.2], [0.0, 0.2], [-0.3, 0.2], [0.3, -0.2], [0.0, -0.2], [-0.3, -0.2]]
    places = ends(start, [[x + 0.12, y] for x, y in start])
    tips = transition("1111100000", "1111100001", "1000011111", "1111100000", "1000011111", "1000011111")
    hurries = transition("1111101111", "1111111011", "1110111111", "1101111111", "1011111111", "1111111101")
    assert order(hurries, places, 0.008)[2] > order(tips, places, 0.008)[2], "the one is in a hurry"
    assert order(hurries, places, 0.008) < order(tips, places, 0.008)


def test_a_tripod_turns_twice_and_a_long_wave_is_thinned_out() -> None:
    tripod = FootfallPattern(np.array([[True] * 6 + [False] * 6, [False] * 6 + [True] * 6]), ("L1", "R1"), True, "")
    assert turning_points(tripod) == [0, 6]
    wave = FootfallPattern(~np.repeat(np.eye(12, dtype=bool), 3, axis=1), tuple("abcdefghijkl"), True, "")
    assert len(turning_points(wave)) == MOST_COLUMNS
    assert turning_points(wave)[0] == 0


@pytest.fixture(scope="module")
def tripod() -> tuple[RobotModel, MotionPlan]:
    robot = gf.load_robot("hexapod")
    return robot, gf.plan_gait(robot, gf.synthesize_gait_pattern(robot, columns=12), samples_per_column=1)


def test_patterns_lie_between_columns_at_which_the_gaits_turn(tripod: tuple[RobotModel, MotionPlan]) -> None:
    robot, gait = tripod
    found = meetings(robot, gait, gait, 11, 0.125, 4, 1, {})
    assert found
    for pattern in found:
        np.testing.assert_array_equal(pattern.contact[:, 0], gait.pattern.contact[:, pattern.info["from_column"]])
        np.testing.assert_array_equal(pattern.contact[:, -1], gait.pattern.contact[:, pattern.info["to_column"]])
        assert pattern.info["from_column"] in turning_points(gait.pattern)
    only = meetings(robot, gait, gait, 11, 0.125, 4, 1, {}, leave=0)
    assert {pattern.info["from_column"] for pattern in only} == {0}


def test_no_pattern_between_any_two_columns_is_infeasible(tripod: tuple[RobotModel, MotionPlan]) -> None:
    robot, gait = tripod
    with pytest.raises(InfeasibleFootfall):
        meetings(robot, gait, gait, 11, 0.125, 4, 1, {"constraints": (StanceCount(at_least=6),)})
