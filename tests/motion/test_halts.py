"""What a robot does when limbs have failed: the rest of a cycle, a halt, and a stand clear of what hangs low."""

from __future__ import annotations

import numpy as np
import pinocchio
import pytest

import gaitforge as gf
from gaitforge.footfall.given import stand_pattern
from gaitforge.motion.constraints.off_ground import OffGround
from gaitforge.motion.failure.cut import begun
from gaitforge.motion.failure.halt import CLEAR_M, foot_points, lowest, plan_clear, plan_halt
from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.state import end_state
from gaitforge.robot.model import RobotModel
from gaitforge.verify.support import static_margin
from tests.motion.motion_kit import PATIENT, instance, open_segment

ON_GROUND, IN_AIR = "R1", "L3"
"""Limbs of the tripod that stand and swing at column 3."""


def failed(robot: RobotModel, until: MotionPlan, *limbs: str) -> dict[str, gf.Failed]:
    """The roles of limbs that are locked where a plan ends."""
    at = {n: until.joint_positions[robot.joint_indices(robot.limb(n)), -1] for n in limbs}
    return {n: gf.Failed(posture=tuple(q.tolist())) for n, q in at.items()}


@pytest.fixture(scope="module")
def until(tripod: MotionPlan) -> MotionPlan:
    return begun(tripod, 3, "until")


@pytest.fixture(scope="module")
def halt(hexapod: RobotModel, until: MotionPlan) -> MotionPlan:
    return plan_halt(hexapod, until, failed(hexapod, until, ON_GROUND, IN_AIR), options=PATIENT)


@pytest.fixture(scope="module")
def clear(hexapod: RobotModel, until: MotionPlan, halt: MotionPlan) -> MotionPlan:
    return plan_clear(hexapod, halt, failed(hexapod, until, ON_GROUND, IN_AIR), options=PATIENT)


@pytest.mark.parametrize("columns", [1, 5, 11])
def test_the_first_columns_of_a_gait_are_the_gait(gait: MotionPlan, columns: int) -> None:
    part = begun(gait, columns, "part")
    times = np.linspace(0.0, part.duration, 37)
    np.testing.assert_allclose(part.joint_spline(times), gait.joint_spline(times), atol=1e-9)
    np.testing.assert_allclose(part.base_spline(times), gait.base_spline(times), atol=1e-9)
    np.testing.assert_array_equal(part.pattern.contact, gait.pattern.contact[:, :columns])
    assert part.duration == pytest.approx(gait.duration * columns / gait.pattern.columns)
    assert not part.pattern.cyclic


@pytest.mark.parametrize("columns", [0, 12, -1])
def test_no_column_and_the_whole_cycle_are_no_part_of_a_gait(tripod: MotionPlan, columns: int) -> None:
    with pytest.raises(ValueError, match="columns"):
        begun(tripod, columns, "part")


def test_a_plan_ends_where_its_base_is_and_stops_when_told(
    hexapod: RobotModel, tripod: MotionPlan, turning: MotionPlan
) -> None:
    part = begun(turning, 6, "part")
    state, still = end_state(hexapod, part), end_state(hexapod, part, stopped=True)
    assert state.base[[0, 1, 5]].tolist() == [0.0, 0.0, 0.0]
    speed = np.linalg.norm(part.base_spline(part.duration, 1)[:2])
    assert np.linalg.norm(state.base_velocity[:2]) == pytest.approx(speed)
    ahead = np.arctan2(state.base_velocity[1], state.base_velocity[0])
    assert ahead == pytest.approx(turning.command.heading, abs=0.2), "seen from the body"
    assert not any(v.any() for v in (still.base_velocity, still.joint_velocity, still.com_velocity))
    assert end_state(hexapod, begun(tripod, 3, "p")).ground.tolist() == tripod.pattern.contact[:, 3].tolist()


def test_a_locked_foot_on_the_ground_bears_load_until_the_others_stand(
    hexapod: RobotModel, until: MotionPlan, halt: MotionPlan
) -> None:
    stuck = hexapod.limb_names.index(ON_GROUND)
    rows = hexapod.joint_indices(hexapod.limb(ON_GROUND))
    stays = np.tile(until.joint_positions[rows, -1:], len(halt.times))
    np.testing.assert_allclose(halt.joint_positions[rows], stays, atol=1e-6)
    assert halt.pattern.row(ON_GROUND).all()
    np.testing.assert_allclose(halt.feet[:, stuck, 2], hexapod.limbs[stuck].foot.radius, atol=1e-6)
    assert halt.weights[0, 1, stuck] > 0.0
    way = np.linalg.norm(halt.feet[:, stuck, :2] - halt.feet[0, stuck, :2], axis=1).max()
    assert way < 2e-3, "it rolls at most"


def test_a_halt_ends_on_all_feet_that_are_left(hexapod: RobotModel, halt: MotionPlan) -> None:
    left = [i for i, n in enumerate(hexapod.limb_names) if n != IN_AIR]
    radii = np.array([limb.foot.radius for limb in hexapod.limbs])
    np.testing.assert_allclose(halt.feet[-1, left, 2], radii[left], atol=1e-6)
    assert not halt.pattern.row(IN_AIR).any()
    assert halt.joint_velocity_ends is not None
    assert not halt.joint_velocity_ends.any()


def test_the_stand_after_a_halt_lifts_what_has_failed_off_the_ground(
    hexapod: RobotModel, halt: MotionPlan, clear: MotionPlan
) -> None:
    both = (ON_GROUND, IN_AIR)
    assert lowest(hexapod, halt, both) == pytest.approx(0.0, abs=1e-6)
    assert lowest(hexapod, clear, both) >= CLEAR_M
    assert not any(clear.pattern.row(n).any() for n in both)
    heights = clear.feet[:, hexapod.limb_names.index(ON_GROUND), 2]
    assert np.diff(heights).min() > -1e-3
    rows = [j for n in both for j in hexapod.joint_indices(hexapod.limb(n))]
    np.testing.assert_allclose(
        clear.joint_positions[rows], halt.joint_positions[rows, -1:] + 0 * clear.times, atol=1e-6
    )


@pytest.mark.parametrize(("columns", "limp"), [(8, ("L1", "R1")), (5, ("L3", "R3"))])
def test_feet_put_down_in_a_hurry_land_where_the_body_can_stay(
    hexapod: RobotModel, tripod: MotionPlan, columns: int, limp: tuple[str, ...]
) -> None:
    """Straight below where they are, the centre of mass would end up beside the four of them, or on their edge."""
    until = begun(tripod, columns, "until")
    roles = {n: gf.Failed("limp", role.posture) for n, role in failed(hexapod, until, *limp).items()}
    halt = plan_halt(hexapod, until, roles)
    assert halt.unbalanced_s > 0.0
    stands = np.array([[name not in limp for name in hexapod.limb_names]])
    assert static_margin(halt.com[-1:, :2], halt.feet[-1:, :, :2], stands)[0] > 0.01
    start = static_margin(halt.com[:1, :2], halt.feet[:1, :, :2], stands)[0]
    assert start < 0.01


def test_the_off_ground_rows_are_the_heights_of_the_feet(hexapod: RobotModel) -> None:
    """Against Pinocchio, at random poses of a stand that begins at rest."""
    names = ("L2", "R1")
    pattern = stand_pattern(hexapod, 4, free=names)
    segment = open_segment(hexapod, pattern, "stand", seed=7, resting=(True, False))
    case = instance(segment, seed=7)
    rows_before = case.problem.row_count
    family = OffGround(foot_points(hexapod, names, segment.fixed_joints), 0.01)
    family.add_to(case.problem, case.trajectory)
    values = case.problem.constraint_values(case.x)[rows_before:].reshape(len(names), -1)
    low = case.problem.row_bounds[0][rows_before:].reshape(len(names), -1)
    for at, name in enumerate(names):
        limb = hexapod.limb(name)
        for k, found in enumerate(values[at]):
            base = case.x[case.trajectory.base[k]]
            pose = hexapod.link_pose(limb.foot.link, base, segment.fixed_joints)
            point = pinocchio.SE3(pose).act(np.array(limb.foot.offset))
            assert found == pytest.approx(point[2], abs=1e-9)
        np.testing.assert_allclose(low[at], limb.foot.radius + 0.01)
