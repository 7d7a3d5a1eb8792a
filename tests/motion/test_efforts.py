"""Joint torques that hold the robot: against Pinocchio's inverse dynamics, by hand, and as a bound."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio
import pytest

import gaitforge as gf
from gaitforge.motion.constraints import default_constraints
from gaitforge.motion.constraints.effort import Effort, quasi_static_torques
from gaitforge.motion.effort import effort_ratios, joint_torques
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import Command, MotionPlan
from gaitforge.motion.strength import _too_weak, refuse_weak_modules
from gaitforge.motion.trajectory import Discretisation
from gaitforge.robot.kinematics import LimbPoses, evaluate_limb, limb_parameters
from gaitforge.robot.model import RobotModel
from tests.motion.motion_kit import PATIENT, TRIPOD

GRAVITY = 9.81


def held_torques(robot: RobotModel, base: np.ndarray, q: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """(n_J,) by Pinocchio's RNEA at rest with external forces (n_F,) [N] straight up below every foot."""
    model, data = robot.pin, robot.pin.createData()
    configuration = robot.configuration(base, q)
    pinocchio.forwardKinematics(model, data, configuration)
    pinocchio.updateFramePlacements(model, data)
    outside = [pinocchio.Force.Zero() for _ in range(model.njoints)]
    for limb, force in zip(robot.limbs, forces, strict=True):
        frame = model.frames[model.getFrameId(limb.foot.link, pinocchio.FrameType.BODY)]
        centre = data.oMf[model.getFrameId(limb.foot.link, pinocchio.FrameType.BODY)].act(np.array(limb.foot.offset))
        point = centre - [0.0, 0.0, limb.foot.radius]
        push = np.array([0.0, 0.0, force])
        world = pinocchio.Force(push, np.cross(point, push))
        outside[frame.parentJoint] += data.oMi[frame.parentJoint].actInv(world)
    still = np.zeros(model.nv)
    tau = pinocchio.rnea(model, data, configuration, still, still, pinocchio.StdVec_Force(outside))
    return tau[robot._q_index - 1]


@pytest.mark.parametrize("side", [0, 1])
def test_torques_are_those_of_pinocchio(plan: MotionPlan, robot_of, side: int) -> None:
    robot = robot_of(plan)
    torques, limbs = joint_torques(robot, plan), np.concatenate([robot.joint_indices(x) for x in robot.limbs])
    for k in range(0, len(plan.times), 3):
        forces = robot.mass * GRAVITY * plan.weights[k, side]
        expected = held_torques(robot, plan.base_poses[k], plan.joint_positions[:, k], forces)
        assert np.abs(torques[k, side] - expected)[limbs].max() < 1e-9


def test_torques_of_a_laden_robot_are_those_of_pinocchio(hexapod: RobotModel) -> None:
    load = gf.Load(1.0, (0.1, 0.0, 0.1))
    plan = gf.plan_gait(hexapod, TRIPOD, loads=[load], roll=0.05, samples_per_column=2, options=PATIENT)
    laden = hexapod.carrying(load)
    forces = laden.mass * GRAVITY * plan.weights[2, 1]
    expected = held_torques(laden, plan.base_poses[2], plan.joint_positions[:, 2], forces)
    limbs = np.concatenate([laden.joint_indices(x) for x in laden.limbs])
    assert np.abs(joint_torques(hexapod, plan)[2, 1] - expected)[limbs].max() < 1e-9


def test_every_plan_reports_its_largest_effort(hexapod: RobotModel, tripod: MotionPlan) -> None:
    ratios = effort_ratios(hexapod, tripod)
    assert set(ratios) == set(hexapod.limb_names)
    assert tripod.report.details["effort_ratio"] == pytest.approx(max(ratios.values()))
    assert tripod.report.details["effort_ratios"] == pytest.approx(ratios)


def test_rows_are_torques_over_their_limits(hexapod: RobotModel) -> None:
    options = replace(PATIENT, constraints=(*default_constraints(), Effort(0.7)), table=True)
    plan = gf.plan_gait(hexapod, TRIPOD, samples_per_column=2, options=options)
    assert max(effort_ratios(hexapod, plan).values()) <= 0.7 + 1e-6
    (row,) = (row for row in plan.report.table if row.family == "effort")
    tripods = 2  # every limb is in one set at all samples, in both at the two where all feet change
    assert row.rows == 3 * 6 * (24 + tripods)


def test_a_bound_on_torque_changes_the_gait(hexapod: RobotModel) -> None:
    free = gf.plan_gait(hexapod, TRIPOD, samples_per_column=2, options=PATIENT)
    peak = max(effort_ratios(hexapod, free).values())
    options = replace(PATIENT, constraints=(*default_constraints(), Effort(0.93 * peak)))
    bound = gf.plan_gait(hexapod, TRIPOD, samples_per_column=2, options=options)
    assert max(effort_ratios(hexapod, bound).values()) <= 0.93 * peak + 1e-6
    assert bound.report.cost > free.report.cost


def bounded(share: float) -> MotionOptions:
    """With the bound, and a body that stays where it is, for a short proof."""
    return replace(PATIENT, constraints=(*default_constraints(), Effort(share)), tilt_limit=0.03, height_range=0.01)


def test_a_robot_too_weak_is_found_before_it_is_switched_on(hexapod: RobotModel) -> None:
    weak = replace(hexapod, effort=0.03 * hexapod.effort)
    with pytest.raises(gf.errors.InfeasibleMotion, match="cannot hold hexapod: of 3 feet") as caught:
        gf.plan_gait(weak, TRIPOD, options=bounded(0.8))
    assert caught.value.explain["families"] == ["effort"]


def strongest_by_brute_force(robot: RobotModel, limb: str, share: float, count: int = 31) -> float:
    """[N] largest vertical force a limb holds on a fine grid of stances: what a proof must not contradict."""
    rows = robot.joint_indices(robot.limb(limb))
    axes = [np.linspace(a, b, count) for a, b in zip(robot.lower[rows], robot.upper[rows], strict=True)]
    joints = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(rows))
    joints = joints[::3]
    geometry, radius = limb_parameters(robot, robot.limb(limb)), robot.limb(limb).foot.radius
    foot = evaluate_limb(joints, geometry).foot
    height = robot.nominal.body_height
    stands = np.abs(radius - foot[:, 2] - height) <= bounded(share).height_range
    level = np.zeros((int(stands.sum()), 3))
    poses = LimbPoses(*(part[None] for part in evaluate_limb(joints[stands], geometry)))
    weightless, one = (
        quasi_static_torques(poses, geometry[None], level, np.array([radius]), np.full((1, len(level)), f))[0]
        for f in (0.0, 1.0)
    )
    limits = share * robot.effort[rows]
    with np.errstate(divide="ignore", invalid="ignore"):
        most = np.where(np.abs(weightless) <= limits, (limits + np.abs(weightless)) / np.abs(one - weightless), 0.0)
    return float(most.min(axis=1).max())


def test_no_stance_of_a_limb_that_is_called_too_weak_holds_the_weight(
    hexapod: RobotModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("gaitforge.motion.strength.MOST_CELLS", 30_000)
    grid = Discretisation(TRIPOD, 1, 2.0, Command())
    strongest = strongest_by_brute_force(hexapod, "L2", 0.03)
    said = [
        force
        for force in np.array([0.25, 0.9, 11.0]) * strongest
        if _too_weak(hexapod, hexapod.limb("L2"), grid, bounded(0.03), 0.03, force)
    ]
    assert said, "nothing was proved"
    assert min(said) > strongest


def test_a_robot_that_can_is_not_refused(hexapod: RobotModel, tripod: MotionPlan) -> None:
    grid = Discretisation(TRIPOD, 1, 2.0, Command())
    refuse_weak_modules(hexapod, grid, bounded(1.2 * max(effort_ratios(hexapod, tripod).values())))
    refuse_weak_modules(replace(hexapod, effort=1e-3 * hexapod.effort), grid, MotionOptions())  # no bound was asked for


def test_a_plan_beyond_the_effort_limits_says_so(hexapod: RobotModel) -> None:
    weak = replace(hexapod, effort=0.5 * hexapod.effort)
    plan = gf.plan_gait(weak, TRIPOD, samples_per_column=2, options=PATIENT)
    assert plan.report.details["effort_ratio"] > 1.0
    assert any("of its effort limit" in words for words in plan.relaxed)
