"""Options of segments in which limp limbs are beside or below: more room, feet that rest, limbs that stay up."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from gaitforge.pipeline.options import Options
from gaitforge.robot.model import RobotModel
from gaitforge.task.roles import Failed

CLEARANCE_M = 0.01
"""[m] kept between bodies once limbs hang limp: they swing, and friction holds them a little beside their place"""
STILL_M = 1e-4
"""[m] that splines may push feet into the ground between samples: on the steep legs of a body that stands
high, feet that work against each other lift it off all but two, and its margin is none"""
FINEST = 10
"""Samples a column that refinement may use for that"""
LIFT_M = 0.04
"""[m] that limbs too long to hang clear are off the ground by their foreseen posture: friction may bend them less"""


def spaced(robot: RobotModel, options: Options, roles: Mapping[str, Failed]) -> Options:
    """The options where limbs hang limp: more room between bodies, those lifted that touch the ground, stiller feet."""
    from gaitforge.motion.constraints.off_ground import OffGround
    from gaitforge.motion.failure.hanging import spheres
    from gaitforge.motion.failure.raised import touches
    from gaitforge.motion.options import MotionOptions

    hangs = {n: np.array(role.posture) for n, role in roles.items() if role.mode == "limp"}
    motion = options.motion or MotionOptions()
    motion = replace(
        motion,
        clearance=max(motion.clearance, CLEARANCE_M),
        ground_tolerance=min(motion.ground_tolerance, STILL_M),
        finest=max(motion.finest, FINEST),
    )
    long = {n: q for n, q in hangs.items() if touches(robot, {n: q})}
    if long:
        points = tuple(point for n, q in long.items() for point in spheres(robot, robot.limb(n), q))
        motion = replace(motion, constraints=(*motion.constraints, OffGround(points, LIFT_M)))
    return replace(options, motion=motion)


def unlifted(options: Options) -> Options:
    """The options of segments in which the body is down."""
    from gaitforge.motion.constraints.off_ground import OffGround

    assert options.motion is not None
    families = tuple(f for f in options.motion.constraints if not (isinstance(f, OffGround) and f.height == LIFT_M))
    return replace(options, motion=replace(options.motion, constraints=families))
