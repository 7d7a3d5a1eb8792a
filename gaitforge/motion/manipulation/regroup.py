"""Standing on other limbs: those that let a load go are put down, those that take the next one are lifted."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product

import numpy as np

from gaitforge.errors import UnsolvedError
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion.manipulation.ends import Arrival
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.still import calm, static_margin
from gaitforge.motion.transition import plan_transition
from gaitforge.robot.model import RobotModel

LAND, STEP, PAUSE, LIFT = 8, 2, 1, 6
"""[columns] of the way to the ground, of a step, of all feet there after either; and while limbs lift that are in
the way of others"""
COLUMNS_S = (0.3, 0.2, 0.25)
"""[s] of a column, tried in this order"""
AMPLE = 0.008
"""[m]"""


def regroup_pattern(before: MotionPlan, after: MotionPlan, rear_first: bool = False) -> FootfallPattern:
    """First the limbs land that let go, then those lift that are to hold, and last all that walk step one by one.

    Who lands does so where there is room; only when the others are out of the way can every foot go to its place.
    """
    limbs = before.pattern.limbs
    stands, walks = before.pattern.contact[:, -1], after.pattern.contact[:, 0]
    lifted, steps = LAND + PAUSE, np.flatnonzero(walks)
    contact = np.zeros((len(limbs), lifted + LIFT + len(steps) * (STEP + PAUSE)), dtype=bool)
    contact[stands | walks] = True
    contact[~stands, :LAND] = False
    contact[~walks, lifted:] = False
    for k, limb in enumerate(steps[::-1] if rear_first else steps):
        at = lifted + LIFT + k * (STEP + PAUSE)
        contact[limb, at : at + STEP] = False
    return FootfallPattern(contact, limbs, cyclic=False, source="given")


def regroup_plans(
    robot: RobotModel, before: MotionPlan, after: MotionPlan, options: MotionOptions
) -> Iterator[MotionPlan]:
    """From the rest in which `before` ends to that in which `after` begins, the base back where it was: ways to do it.

    Two orders of steps and some paces are tried, at first with a body that is slow to sway; those come out whose centre
    of mass and zero-moment point stay `AMPLE` inside the feet.  Raises `UnsolvedError` when there is none.
    """
    still = min(options.ground_tolerance, options.change_tolerance)
    fixed = replace(options, constraints=(*options.constraints, Arrival()), ground_tolerance=still, explain=False)
    name, failure, found = f"{before.name}_to_{after.name}", None, False
    for how, rear_first, seconds in product((calm(fixed), fixed), (False, True), COLUMNS_S):
        pattern = regroup_pattern(before, after, rear_first)
        try:
            plan = plan_transition(robot, before, after, pattern=pattern, column_s=seconds, name=name, options=how)
        except UnsolvedError as error:
            failure = failure or error
            continue
        margin = min(float(plan.report.details["zmp_margin_m"]), static_margin(robot, plan))
        if margin >= AMPLE:
            found = True
            yield plan
            continue
        text = f"{name}: the centre of mass or the zero-moment point comes to be {1000 * margin:.0f} mm inside the feet"
        failure = failure or UnsolvedError(
            text, {"segment": name, "families": ["balance"], "value": margin, "unit": "m"}
        )
    if not found and failure is not None:
        raise failure
