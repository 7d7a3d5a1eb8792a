"""The structured solver on motion problems, against IPOPT and against derivatives put together apart from it."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

import gaitforge as gf
from gaitforge.errors import UnsolvedError
from gaitforge.motion.assembly import assemble
from gaitforge.motion.plan import Command
from gaitforge.motion.problem import Problem
from gaitforge.motion.solvers.ipopt import Ipopt
from gaitforge.motion.solvers.solution import Solution, Start
from gaitforge.motion.solvers.structured import Structured
from gaitforge.motion.solvers.workspace import forget, workspace_of
from gaitforge.robot.model import RobotModel
from tests.motion.motion_kit import PATIENT, TRIPOD, gait_segment, instance, open_segment

ALONE = Structured(fallback=None)
FAST = replace(PATIENT, solver=ALONE)


class Witness:
    """Solves with the structured solver and keeps what it was asked to solve."""

    def __init__(self, solver: Structured = ALONE) -> None:
        self.solver, self.problems = solver, list[Problem]()

    def solve(self, problem: Problem, start: Start = None) -> Solution:
        self.problems.append(problem)
        return self.solver.solve(problem, start)


@pytest.fixture(scope="module")
def problems(hexapod: RobotModel, quadruped: RobotModel) -> dict[str, Problem]:
    """Real problems as planning poses them, those of refinement (joint speeds, clearances) too."""
    witness = Witness()
    options = replace(PATIENT, solver=witness)
    wave = gf.synthesize_gait_pattern(quadruped, method="wave", columns=quadruped.nominal.columns)
    posed: dict[str, Problem] = {}

    def note(name: str) -> None:
        for turn, problem in enumerate(witness.problems):
            posed[f"{name} {turn}"] = problem
        witness.problems = []

    six = gf.plan_gait(hexapod, TRIPOD, samples_per_column=1, options=options)
    note("tripod")
    turned = gf.plan_gait(
        hexapod, TRIPOD, speed=0.05, heading=0.3, yaw_rate=0.15, samples_per_column=2, options=options
    )
    note("turning")
    gf.plan_gait(quadruped, wave, samples_per_column=2, options=options)
    note("wave")
    gf.plan_transition(hexapod, six, turned, options=options)
    note("transition")
    gf.plan_start(hexapod, six, options=options)
    note("start")
    return posed


NAMES = ("tripod 0", "turning 0", "wave 0", "transition 0", "start 0")


@pytest.mark.parametrize("name", NAMES)
def test_plans_cost_what_they_cost_with_ipopt(name: str, problems: dict[str, Problem]) -> None:
    problem = problems[name]
    reference, ours = Ipopt(max_seconds=120.0).solve(problem), ALONE.solve(problem)
    assert reference.solved
    assert ours.solved, ours.status
    assert ours.cost <= reference.cost * (1 + 1e-4)
    assert max(value for value, _, _ in problem.violations(ours.x).values()) < 1e-6
    assert ours.iterations <= reference.iterations


@pytest.mark.parametrize("name", NAMES)
def test_a_solution_satisfies_the_optimality_conditions(name: str, problems: dict[str, Problem]) -> None:
    problem = problems[name]
    solution = ALONE.solve(problem)
    built = assemble(problem)  # the derivatives that IPOPT uses
    x, multipliers = solution.x[built.free], solution.multipliers
    assert multipliers is not None
    gradient = np.array(ca.DM(built.options["grad_f"](x, [])[1])).ravel()
    g, jacobian = built.options["jac_g"](x, [])
    bounds = multipliers.bounds[built.free]
    stationarity = gradient + np.array(ca.DM(jacobian)).T @ multipliers.rows + bounds
    assert np.abs(stationarity).max() < 1e-4
    low, high = (b[built.free] for b in problem.bounds)
    row_low, row_high = problem.row_bounds
    for values, lower, upper, force in (
        (x, low, high, bounds),
        (np.array(ca.DM(g)).ravel(), row_low, row_high, multipliers.rows),
    ):
        loose = lower < upper
        pushed_up, pushed_down = loose & (force < -1e-3), loose & (force > 1e-3)
        assert values[pushed_up] == pytest.approx(lower[pushed_up], abs=1e-3), "a bound that pushes is active"
        assert values[pushed_down] == pytest.approx(upper[pushed_down], abs=1e-3)
        assert (values >= lower - 1e-6).all()
        assert (values <= upper + 1e-6).all()


@pytest.mark.parametrize("kind", ["gait", "transition", "stand"])
def test_derivatives_are_those_that_ipopt_uses(kind: str, hexapod: RobotModel) -> None:
    if kind == "gait":
        segment = gait_segment(hexapod, TRIPOD, Command(0.05, 0.3, 0.15))
    else:
        pattern = replace(TRIPOD, cyclic=False)
        segment = open_segment(hexapod, pattern, kind, resting=(kind == "stand", False))
    case = instance(segment)
    built, workspace = assemble(case.problem), workspace_of(case.problem)
    multipliers = np.random.default_rng(0).normal(size=case.problem.row_count)
    x = case.x[built.free]
    ours = workspace.evaluation
    ours.load(case.problem)
    ours.derivatives(x, multipliers)
    f, gradient = built.options["grad_f"](x, [])
    g, jacobian = built.options["jac_g"](x, [])
    upper = np.array(ca.DM(built.options["hess_lag"](x, [], 1.0, multipliers)))
    count, (indices, indptr) = len(x), workspace.structure.pattern
    dense = np.zeros((workspace.structure.dimension,) * 2)
    dense[indices, np.repeat(np.arange(len(indptr) - 1), np.diff(indptr))] = ours.kkt
    assert ours.cost == pytest.approx(float(f), rel=1e-12)
    assert ours.gradient == pytest.approx(np.array(ca.DM(gradient)).ravel(), abs=1e-9)
    assert ours.rows == pytest.approx(np.array(ca.DM(g)).ravel(), abs=1e-12)
    assert dense[:count, :count] == pytest.approx(upper, abs=1e-8)
    assert dense[:count, count:] == pytest.approx(np.array(ca.DM(jacobian)).T, abs=1e-10)
    assert not dense[count:, count:].any()
    cost, rows = ours.values(x)
    assert cost == pytest.approx(float(f), rel=1e-12)
    assert rows == pytest.approx(ours.rows, abs=1e-14)


def test_gaits_transitions_and_stands_are_planned_without_a_fallback(hexapod: RobotModel) -> None:
    six = gf.plan_gait(hexapod, TRIPOD, name="six", options=FAST)
    back = gf.plan_gait(hexapod, TRIPOD, name="back", heading=np.pi, options=FAST)
    start = gf.plan_start(hexapod, six, options=FAST)
    change = gf.plan_transition(hexapod, six, back, options=FAST)
    stop = gf.plan_stop(hexapod, back, options=FAST)
    for plan in (six, back, start, change, stop):
        assert plan.report.status == "solved"
        assert plan.report.residual < 1e-6


def test_a_solution_is_a_good_start_for_its_neighbour(hexapod: RobotModel) -> None:
    slow, fast = (gait_segment(hexapod, TRIPOD, Command(v)).build(PATIENT)[0] for v in (0.060, 0.064))
    before = ALONE.solve(slow)
    cold, warm = ALONE.solve(fast), ALONE.solve(fast, before)
    assert cold.solved
    assert warm.solved
    assert warm.cost == pytest.approx(cold.cost, rel=1e-5)
    assert warm.iterations < cold.iterations


def test_numbers_change_and_the_structure_stays(hexapod: RobotModel) -> None:
    forget()
    one, two = (gait_segment(hexapod, TRIPOD, Command(v)).build(PATIENT)[0] for v in (0.05, 0.06))
    three = gait_segment(hexapod, TRIPOD, Command(0.05), r=2).build(PATIENT)[0]
    assert workspace_of(one) is workspace_of(two)
    assert workspace_of(one) is not workspace_of(three)


def test_too_fast_is_given_up_in_few_iterations_and_named(hexapod: RobotModel) -> None:
    pattern = gf.synthesize_gait_pattern(hexapod, columns=8)
    problem, _ = gait_segment(hexapod, pattern, Command(0.6), r=2).build(PATIENT)
    solution = replace(ALONE, restoration=False).solve(problem)
    assert not solution.solved
    assert solution.status == "stalled"
    assert solution.iterations < 60
    family, (value, label, _) = max(solution.worst.items(), key=lambda item: item[1][0])
    assert family in ("kinematics", "rolling", "balance")
    assert value > 1e-3
    assert label[0].split("+")[0] in hexapod.limb_names


def test_a_gait_on_which_the_iteration_stalls_is_solved_from_the_point_that_violates_it_least(
    quadruped: RobotModel,
) -> None:
    """Turning at 2 rad/s; IPOPT finds the same plan."""
    bare = Witness(replace(ALONE, restoration=False))
    options = replace(gf.MotionOptions(), solver=bare, explain=False)
    pattern = gf.synthesize_gait_pattern(quadruped, columns=12)
    with pytest.raises(UnsolvedError):
        gf.plan_gait(quadruped, pattern, speed=0.064, yaw_rate=2.0, duration=2.0, options=options)
    problem = bare.problems[0]
    assert bare.solver.solve(problem).status == "stalled"
    found = ALONE.solve(problem)
    assert found.solved
    assert found.residual < 1e-6
    assert found.cost <= Ipopt(max_seconds=120.0).solve(problem).cost * (1 + 1e-4)


PLAN = """
import sys, numpy as np, gaitforge as gf
from gaitforge.motion.solvers.structured import Structured
robot = gf.load_robot("hexapod")
options = gf.MotionOptions(solver=Structured(fallback=None))
gait = gf.plan_gait(robot, gf.synthesize_gait_pattern(robot), samples_per_column=1, options=options)
sys.stdout.write(gait.joint_positions.tobytes().hex())
"""


def test_one_process_or_another_the_plan_is_the_same(hexapod: RobotModel) -> None:
    pattern = gf.synthesize_gait_pattern(hexapod)
    here = [gf.plan_gait(hexapod, pattern, samples_per_column=1, options=FAST).joint_positions for _ in range(2)]
    out = subprocess.run([sys.executable, "-c", PLAN], capture_output=True, text=True, check=True).stdout
    there = np.frombuffer(bytes.fromhex(out)).reshape(here[0].shape)
    assert np.abs(here[0] - here[1]).max() <= 1e-9
    assert np.abs(here[0] - there).max() <= 1e-9
