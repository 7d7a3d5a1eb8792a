"""Gaits of patterns that come with footholds: the plan stands on them, unless a posture is asked for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapely.geometry import MultiPoint, Point

import gaitforge as gf
from gaitforge.footfall.constraints import SupportSectors, default_constraints
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion.plan import MotionPlan
from gaitforge.robot.model import RobotModel
from tests.motion.motion_kit import PATIENT


@pytest.fixture(scope="module")
def placed(hexapod: RobotModel) -> FootfallPattern:
    """L2 lost: the body moves to where five feet hold it well."""
    walking = [name for name in hexapod.limb_names if name != "L2"]
    families = (*default_constraints(), SupportSectors())
    return gf.synthesize_gait_pattern(hexapod, locomotive=walking, constraints=families)


def static_margin(plan: MotionPlan) -> float:
    """[m] least distance of the centre of mass from the edge of the feet of the intervals on either side."""
    contact, samples, worst = plan.pattern.contact, plan.samples_per_column, np.inf
    for k in range(len(plan.times) - 1):
        for interval in (k - 1, k):
            standing = contact[:, (interval // samples) % contact.shape[1]]
            polygon = MultiPoint([tuple(foot) for foot in plan.feet[k, standing, :2]]).convex_hull
            point = Point(*plan.com[k, :2])
            worst = min(worst, polygon.exterior.distance(point) * (1 if polygon.covers(point) else -1))
    return worst


def test_a_gait_stands_where_its_pattern_was_placed_and_is_steadier_there(
    hexapod: RobotModel, placed: FootfallPattern
) -> None:
    unplaced = replace(placed, info={key: value for key, value in placed.info.items() if key != "posture_rad"})
    here, there = (gf.plan_gait(hexapod, p, options=PATIENT) for p in (placed, unplaced))
    assert static_margin(here) > static_margin(there) + 0.01
    walking = [hexapod.limb_names.index(name) for name in placed.locomotive]
    footholds = np.array(placed.info["footholds_m"])[walking]
    stood = np.array(
        [np.mean((here.feet[:, i, :2] - here.base_poses[:, :2])[here.feet[:, i, 2] < 0.03], axis=0) for i in walking]
    )
    assert stood == pytest.approx(footholds, abs=0.03)


def test_a_posture_that_is_asked_for_is_taken_all_the_same(hexapod: RobotModel, placed: FootfallPattern) -> None:
    plan = gf.plan_gait(hexapod, placed, posture="nominal", options=PATIENT)
    assert plan.stance.joints == pytest.approx(hexapod.nominal.posture)
