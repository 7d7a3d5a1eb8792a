"""Stance feet roll and do not slip: the constraint against numeric integration, the plans against Pinocchio."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio
import pytest

from gaitforge.motion.dense import check_densely
from gaitforge.motion.plan import Command, MotionPlan
from gaitforge.robot.model import RobotModel
from tests.motion.motion_kit import PENTA, feet_in_motion, gait_segment, held, instance

STEPS = 60


def rolled(robot: RobotModel, limb: int, poses: tuple[np.ndarray, np.ndarray], joints: tuple[np.ndarray, np.ndarray]):
    """(2,) way of the centre of a foot sphere that rolls while base pose and joints go straight from one to the other.

    A sphere that does not slip: v = ω × r ẑ, integrated by the midpoint rule.
    """
    model, data = robot.pin, robot.pin.createData()
    frame = model.getFrameId(robot.limbs[limb].foot.link, pinocchio.FrameType.BODY)
    way = np.zeros(3)
    for n in range(STEPS):
        s = (n + 0.5) / STEPS
        base, q = ((1 - s) * a + s * b for a, b in (poses, joints))
        v = robot.velocity_vector(base, poses[1] - poses[0], joints[1] - joints[0])
        pinocchio.forwardKinematics(model, data, robot.configuration(base, q), v)
        pinocchio.updateFramePlacements(model, data)
        turn = pinocchio.getFrameVelocity(model, data, frame, pinocchio.LOCAL_WORLD_ALIGNED).angular
        way += np.cross(turn, [0.0, 0.0, robot.limbs[limb].foot.radius]) / STEPS
    return way[:2]


@pytest.mark.parametrize("yaw_rate", [0.0, 0.4])
def test_the_rolling_rows_agree_with_a_sphere_rolled_in_fine_steps(hexapod: RobotModel, yaw_rate: float) -> None:
    """Rows are way − rolling; the sphere's way comes from integration, in the frame of the earlier sample."""
    errors = {}
    for scale in (1.0, 0.5):
        segment = gait_segment(hexapod, PENTA, Command(0.06, 0.2, scale * yaw_rate), r=1)
        case = instance(segment, spread=0.0)
        trajectory, grid, rng = case.trajectory, case.trajectory.grid, np.random.default_rng(3)
        x = case.x.copy()
        middle = {i: hexapod.nominal.posture[hexapod.joint_indices(hexapod.limbs[i])] for i in trajectory.moving}
        for n in range(grid.samples):  # foot links turn by up to 0.2 rad an interval, or half of that
            x[trajectory.base[n]] = scale * rng.normal(0.0, 0.015, 6)
            for i in trajectory.moving:
                x[trajectory.joints[i][n]] = middle[i] + scale * rng.normal(0.0, 0.04, 3)
        values = case.problem.constraint_values(x)
        blocks = [b for b in case.problem.rows if b.family == "rolling"]
        worst = 0.0
        for block in blocks:
            for row, (name, k) in zip(range(0, len(block.lower), 2), block.labels[::2], strict=True):
                i = hexapod.limb_names.index(name)
                after = (k + 1) % grid.samples
                poses = x[trajectory.base[k]], _carried(x[trajectory.base[after]], grid.step)
                joints = np.tile(trajectory.fixed_joints, (2, 1))
                joints[:, hexapod.joint_indices(hexapod.limbs[i])] = x[trajectory.joints[i][[k, after]]]
                feet = x[trajectory.feet[i][k]], _carried(np.append(x[trajectory.feet[i][after]], [0] * 3), grid.step)
                slipped = feet[1][:2] - feet[0][:2] - rolled(hexapod, i, poses, (joints[0], joints[1]))
                found = values[block.start + row : block.start + row + 2]
                worst = max(worst, float(np.abs(found - slipped).max()))
        errors[scale] = worst
    assert errors[1.0] < 5e-5, "of some 5 mm"
    assert errors[0.5] < errors[1.0] / 5, "third order in the angle"


def _carried(pose: np.ndarray, step: np.ndarray) -> np.ndarray:
    """A pose of the next sample's frame in the frame of this one."""
    c, s = np.cos(step[2]), np.sin(step[2])
    moved = pose.copy()
    moved[:2] = np.array([[c, -s], [s, c]]) @ pose[:2] + step[:2]
    moved[5] += step[2]
    return moved


def slips(robot: RobotModel, plan: MotionPlan, per_interval: int = 16) -> tuple[float, float]:
    """(m, m) farthest that the lowest point of a foot has slid within a stance: at samples, and anywhere."""
    n = (len(plan.times) - 1) * per_interval
    times = (np.arange(n) + 0.5) * plan.duration / n
    _, velocities = feet_in_motion(robot, plan, times)
    at_samples, anywhere = 0.0, 0.0
    for i, stance in enumerate(held(plan, times).T):
        run = np.zeros(2)
        for k in range(n):
            run = run + velocities[k, i, :2] * plan.duration / n if stance[k] else np.zeros(2)
            anywhere = max(anywhere, float(np.linalg.norm(run)))
            if (k + 1) % per_interval == 0:
                at_samples = max(at_samples, float(np.linalg.norm(run)))
    return at_samples, anywhere


def test_feet_in_stance_are_where_rolling_brought_them_at_every_sample(plan: MotionPlan, robot_of) -> None:
    at_samples, _ = slips(robot_of(plan), plan)
    assert at_samples < 2e-4


@pytest.mark.parametrize(
    ("name", "limit"), [("tripod", 1.5e-3), ("penta", 1.5e-3), ("wave", 1.5e-3), ("change", 2e-3), ("stop", 3e-3)]
)
def test_feet_in_stance_hardly_slip_between_samples(
    request: pytest.FixtureRequest, robot_of, name: str, limit: float
) -> None:
    plan = request.getfixturevalue(name)
    _, anywhere = slips(robot_of(plan), plan)
    assert anywhere < limit


def test_the_dense_check_measures_the_slip_that_pinocchio_sees(plan: MotionPlan, robot_of) -> None:
    robot = robot_of(plan)
    _, anywhere = slips(robot, plan)
    found = check_densely(robot, plan, 0.0, per_interval=16).slip
    assert found == pytest.approx(anywhere, abs=1e-4)


def test_a_plan_whose_stance_foot_is_dragged_has_slip(hexapod: RobotModel, tripod: MotionPlan) -> None:
    joints = tripod.joint_positions.copy()
    joints[0] += 0.05 * np.sin(2 * np.pi * tripod.times / tripod.duration)  # L1's yaw joint
    dragged = replace(tripod, joint_positions=joints)
    assert check_densely(hexapod, dragged, 0.0).slip > 5e-3
    assert slips(hexapod, dragged)[1] > 5e-3
