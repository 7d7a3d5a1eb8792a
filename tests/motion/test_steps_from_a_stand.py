"""Steps from a stand: the centre of mass itself stays over the feet, and the body does not swing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapely.geometry import MultiPoint, Point

import gaitforge as gf
from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.still import CREEP_M, calm, quiet, static_margin, stepping
from gaitforge.robot.kinematics import feet_in_world
from gaitforge.robot.model import RobotModel
from tests.motion.motion_kit import PATIENT, TRIPOD

BRISK = {"speed": 0.12, "duration": 1.0, "samples_per_column": 2}
"""A gait so quick that the CoP is some way off the centre of mass."""


@pytest.fixture(scope="module")
def plans(hexapod: RobotModel) -> dict[str, MotionPlan]:
    kinds = {"as it is": PATIENT, "calm": calm(PATIENT), "still": stepping(PATIENT)}
    return {name: gf.plan_gait(hexapod, TRIPOD, options=options, **BRISK) for name, options in kinds.items()}


def test_the_static_margin_is_the_distance_of_the_centre_of_mass_from_the_edge(
    hexapod: RobotModel, plans: dict[str, MotionPlan]
) -> None:
    plan = plans["as it is"]
    worst = np.inf
    for t in (np.arange(2 * (len(plan.times) - 1)) + 0.5) * plan.duration / (2 * (len(plan.times) - 1)):
        base, q = plan.base_spline(t), plan.joint_spline(t)
        stance = plan.pattern.contact[:, int(t / plan.duration * plan.pattern.columns)]
        hull = MultiPoint(feet_in_world(hexapod, base[None], q[None])[0, stance, :2]).convex_hull
        com = Point(hexapod.center_of_mass(base, q)[:2])
        worst = min(worst, hull.exterior.distance(com) * (1 if hull.contains(com) else -1))
    assert static_margin(hexapod, plan) == pytest.approx(worst, abs=1e-9)


def test_a_still_balance_keeps_the_centre_of_mass_where_the_centre_of_pressure_was(
    plans: dict[str, MotionPlan],
) -> None:
    """x = Σ w e at every sample, by the plan's own weights and feet."""
    for name, off in (("still", False), ("as it is", True)):
        plan = plans[name]
        balanced = np.einsum("ksi,kid->ksd", plan.weights, plan.feet[:, :, :2])
        error = np.abs(balanced - plan.com[:, None, :2]).max()
        assert (error > 2e-3) if off else (error < 1e-5), name


def test_quiet_options_are_calm_and_never_allow_more_than_was_asked_for() -> None:
    assert quiet(PATIENT) == replace(calm(PATIENT), slip_tolerance=CREEP_M)
    strict = replace(PATIENT, slip_tolerance=1e-4)
    assert quiet(strict) == calm(strict)


def test_calm_plans_accelerate_less(plans: dict[str, MotionPlan]) -> None:
    def effort(plan: MotionPlan) -> float:
        times = np.linspace(0.0, plan.duration, 200)
        return float((plan.base_spline(times, 2)[:, :3] ** 2).mean())

    assert effort(plans["calm"]) < 0.7 * effort(plans["as it is"])
