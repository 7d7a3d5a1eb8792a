"""Exact derivatives of every family, and of the whole problem, against central differences at random points."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from gaitforge.motion import constraints, costs
from gaitforge.motion.assembly import assemble
from gaitforge.motion.constraints.limb_height import LimbHeight
from gaitforge.motion.constraints.locked import Locked
from gaitforge.motion.constraints.off_ground import OffGround
from gaitforge.motion.constraints.placed import Placed
from gaitforge.motion.constraints.trunk_height import TrunkHeight
from gaitforge.motion.costs.pace import Pace
from gaitforge.motion.family import Family
from gaitforge.motion.plan import Command
from gaitforge.motion.problem import Problem, Term
from gaitforge.motion.shins import LowPoint
from gaitforge.robot.model import RobotModel
from tests.motion.motion_kit import CHANGE, PENTA, Instance, gait_segment, instance, open_segment

CONSTRAINTS = {
    "kinematics",
    "center_of_mass",
    "rolling",
    "balance",
    "joint_speed",
    "effort",
    "clearance",
    "off_ground",
    "trunk_height",
    "limb_height",
}
OFF = OffGround((("R1", (0.2, -0.2, -0.05), 0.02),))
LOCKED = Locked(("L1",))
PLACED = Placed(pose=(0.1, 0.02, 0.12, 0.0, 0.05, 0.1))
TRUNK = TrunkHeight(corners=((0.15, 0.09, -0.04), (-0.15, -0.09, -0.04)))
SHIN = LimbHeight((LowPoint(1, 2, (0.01, -0.02, 0.03), 0.02, -0.01), LowPoint(0, 1, (0.1, 0.0, 0.0), 0.02, 0.01)))
COSTS = {"smoothness", "posture", "body", "sharing", "swing"}
STEP = 1e-5


@pytest.fixture(scope="module")
def turning_gait(hexapod: RobotModel) -> Instance:
    return instance(gait_segment(hexapod, PENTA, Command(0.06, 0.4, 0.5)), more=(OFF, TRUNK, SHIN, Pace()))


@pytest.fixture(scope="module")
def transition(hexapod: RobotModel) -> Instance:
    return instance(
        open_segment(hexapod, CHANGE, "transition", seed=5), seed=5, more=(OFF, TRUNK, SHIN, LOCKED, PLACED)
    )


@pytest.fixture(scope="module")
def stand(hexapod: RobotModel) -> Instance:
    pattern = replace(CHANGE, contact=CHANGE.contact[:, -4:])
    return instance(
        open_segment(hexapod, pattern, "stand", seed=7, resting=(True, False)),
        seed=7,
        more=(OFF, TRUNK, SHIN, LOCKED, PLACED),
    )


@pytest.fixture(params=["turning_gait", "transition", "stand"])
def case(request: pytest.FixtureRequest) -> Instance:
    found: Instance = request.getfixturevalue(request.param)
    return found


def only(problem: Problem, family: str) -> Problem:
    """The same variables and rows, with the terms of one family."""
    return replace(problem, terms=[t for t in problem.terms if t.family == family])


def cost_by_hand(problem: Problem, x: np.ndarray) -> float:
    """Σ of every cost term, instance by instance."""
    return sum(
        float(term.kernel.value(x[v], p))
        for term in problem.terms
        if term.rows is None
        for v, p in zip(term.variables, term.parameters, strict=True)
    )


def close(found: np.ndarray, expected: np.ndarray, what: str) -> None:
    scale = max(1.0, float(np.abs(expected).max(initial=0.0)))
    assert np.abs(found - expected).max(initial=0.0) < 2e-7 * scale, what


def test_every_family_is_in_the_cases(turning_gait: Instance, transition: Instance, stand: Instance) -> None:
    seams = {"progress", "locked", "placed"}
    for case, extra, own in ((turning_gait, set(), {"pace"}), (transition, seams, set()), (stand, seams, set())):
        constraints = {t.family for t in case.problem.terms if t.rows is not None}
        assert constraints == CONSTRAINTS | extra
        assert {t.family for t in case.problem.terms if t.rows is None} == COSTS | own
    pairs = {t.kernel.sizes[0] for t in turning_gait.problem.terms if t.family == "clearance"}
    assert pairs == {3, 6}, "a moving body near a resting one, and near another moving one"


def test_no_family_of_the_project_is_left_out() -> None:
    """A family without a place in these cases fails here: in the options' defaults or added by `instance`."""
    found = set()
    for package in (constraints, costs):
        for module in pkgutil.iter_modules(package.__path__):
            for value in vars(importlib.import_module(f"{package.__name__}.{module.name}")).values():
                if isinstance(value, type) and issubclass(value, Family) and not inspect.isabstract(value):
                    found.add(value.name)
    assert found == (CONSTRAINTS | COSTS | {"progress", "locked", "placed", "pace"}) - {"center_of_mass"}


def test_the_kernels_of_every_family_have_the_derivatives_of_their_values(case: Instance) -> None:
    rng = np.random.default_rng(11)
    seen = set()
    for term in case.problem.terms:
        if (term.family, term.kernel.sizes) not in seen:
            seen.add((term.family, term.kernel.sizes))
            for at in rng.choice(len(term.variables), size=min(3, len(term.variables)), replace=False):
                _check_kernel(term, case.x[term.variables[at]], term.parameters[at], rng)
    assert {family for family, _ in seen} >= CONSTRAINTS | COSTS


def _check_kernel(term: Term, v: np.ndarray, p: np.ndarray, rng: np.random.Generator) -> None:
    compiled = term.kernel
    nv, _, nr = compiled.sizes
    lam = rng.normal(size=nr)

    def jacobian(v: np.ndarray) -> np.ndarray:
        dense = np.zeros((nr, nv))
        dense[compiled.jacobian_rc] = np.array(compiled.first(v, p)[1]).ravel()
        return dense

    hessian = np.zeros((nv, nv))
    hessian[compiled.hessian_rc] = np.array(compiled.second(v, p, lam)).ravel()
    hessian += np.triu(hessian, 1).T
    steps = STEP * np.eye(nv)
    slopes = np.stack([np.array(compiled.value(v + s, p) - compiled.value(v - s, p)).ravel() for s in steps], axis=1)
    close(jacobian(v), slopes / (2 * STEP), f"{term.family}: Jacobian")
    bends = np.stack([lam @ (jacobian(v + s) - jacobian(v - s)) for s in steps])
    close(hessian, bends / (2 * STEP), f"{term.family}: Hessian")


@pytest.mark.parametrize("family", [*sorted(CONSTRAINTS | COSTS), "progress", "locked", "placed", "pace", "everything"])
def test_the_assembled_functions_are_the_sums_and_have_their_derivatives(case: Instance, family: str) -> None:
    problem = case.problem if family == "everything" else only(case.problem, family)
    rng = np.random.default_rng(13)
    built = assemble(problem)
    free = case.x[built.free]
    lam_f, lam_g = 1.7, rng.normal(size=problem.row_count)

    def values(x: np.ndarray) -> tuple[float, np.ndarray]:
        full = built.expand(case.problem, x)
        return cost_by_hand(problem, full), problem.constraint_values(full)

    f, gradient = built.options["grad_f"](free, [])
    g, jacobian = built.options["jac_g"](free, [])
    upper = built.options["hess_lag"](free, [], lam_f, lam_g).sparse()
    hessian = upper + ca.triu(upper, False).T
    assert float(f) == pytest.approx(values(free)[0], rel=1e-12, abs=1e-12)
    close(np.array(g).ravel(), values(free)[1], "rows")
    for _ in range(3):
        d = rng.normal(size=len(free))
        d /= np.linalg.norm(d)
        (f_after, g_after), (f_before, g_before) = values(free + STEP * d), values(free - STEP * d)
        slope = np.array([float(ca.dot(gradient, d))])
        close(slope, np.array([(f_after - f_before) / (2 * STEP)]), f"{family}: gradient")
        close(np.array(jacobian @ d).ravel(), (g_after - g_before) / (2 * STEP), f"{family}: Jacobian")
        bend = _lagrangian_slope(built, free + STEP * d, lam_f, lam_g)
        bend = (bend - _lagrangian_slope(built, free - STEP * d, lam_f, lam_g)) / (2 * STEP)
        close(np.array(hessian @ d).ravel(), bend, f"{family}: Hessian of the Lagrangian")


def _lagrangian_slope(built, x: np.ndarray, lam_f: float, lam_g: np.ndarray) -> np.ndarray:
    gradient = built.options["grad_f"](x, [])[1]
    jacobian = built.options["jac_g"](x, [])[1]
    return np.array(lam_f * gradient + jacobian.T @ lam_g).ravel()
