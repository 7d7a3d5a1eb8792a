"""With the best pair of phases, gaits are begun where the transition leaves the one and enters the other."""

from __future__ import annotations

import numpy as np
import pytest

import gaitforge as gf
from gaitforge.footfall.synthesis import transition_pattern_candidates
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import MotionPlan
from gaitforge.pipeline.options import Options, Search
from gaitforge.pipeline.search.transitions import meeting
from gaitforge.robot.model import RobotModel


@pytest.fixture(scope="module")
def gaits() -> tuple[RobotModel, MotionPlan, MotionPlan]:
    robot = gf.load_robot("hexapod")
    tripod = gf.plan_gait(robot, gf.synthesize_gait_pattern(robot, columns=12), samples_per_column=1)
    four = gf.synthesize_gait_pattern(robot, columns=12, method="program", locomotive=["L2", "L3", "R2", "R3", "R1"])
    return robot, tripod, gf.plan_gait(robot, four, speed=0.03, samples_per_column=1)


def options(phases: str) -> Options:
    return Options(simulator=None, recorder=None, search=Search(transition_phases=phases))  # type: ignore[arg-type]


@pytest.mark.parametrize("phases", ["seam", "best"])
def test_a_transition_goes_on_with_what_the_gaits_do_there(
    gaits: tuple[RobotModel, MotionPlan, MotionPlan], phases: str
) -> None:
    robot, before, after = gaits
    found = transition_pattern_candidates(robot, before, after, columns=11, phases=phases, limit=4)
    for pattern in found:
        first, second = meeting(before, after, pattern, options(phases))
        np.testing.assert_array_equal(pattern.contact[:, 0], first.pattern.contact[:, 0])
        np.testing.assert_array_equal(pattern.contact[:, -1], second.pattern.contact[:, -1])
    pairs = {(p.info["from_column"], p.info["to_column"]) for p in found}
    assert (pairs == {(0, 11)}) == (phases == "seam")


def test_the_plan_that_leaves_mid_step_begins_with_the_state_of_the_gait_there(
    gaits: tuple[RobotModel, MotionPlan, MotionPlan],
) -> None:
    robot, before, after = gaits
    (pattern,) = transition_pattern_candidates(robot, before, after, columns=11, phases="best", limit=1)
    first, second = meeting(before, after, pattern, options("best"))
    move = gf.plan_transition(robot, first, second, pattern=pattern)
    deep = move.report.details["penetration_m"]
    assert MotionOptions().change_tolerance < deep <= MotionOptions().ground_tolerance, "grids that are finer have none"
    assert f"feet {1e3 * deep:.1f} mm into the ground between samples" in move.relaxed
    at = pattern.info["from_column"] * before.duration / 12
    np.testing.assert_allclose(move(0.0), before(at), atol=1e-9)
    np.testing.assert_allclose(move.joint_spline(0.0, 1), before.joint_spline(at, 1), atol=1e-6)
    until = (pattern.info["to_column"] + 1) * after.duration / 12
    np.testing.assert_allclose(move(move.duration), after(until), atol=1e-9)
