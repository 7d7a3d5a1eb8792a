"""Starts and stops of a run, with more time, or less, where the usual one does not do."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

from gaitforge.errors import UnsolvedError
from gaitforge.motion.plan import MotionPlan
from gaitforge.pipeline.options import Options
from gaitforge.pipeline.stopwatch import Stopwatch
from gaitforge.robot.model import RobotModel

STRETCHES = (1.0, 1.6, 2.4, 0.6, 0.25)
"""Factors on the time of a stand, tried in this order: more of it for slower joints, less of it for a shorter way,
where a limb that is locked stands in that of its neighbour"""


def plan_stand(
    which: Literal["start", "stop"], robot: RobotModel, gait: MotionPlan, options: Options, watch: Stopwatch,
    name: str | None = None,
) -> MotionPlan:  # fmt: skip
    """From rest into the gait, or from the gait to rest; raises `UnsolvedError` when no time is enough."""
    from gaitforge.motion.options import MotionOptions
    from gaitforge.motion.stand import plan_start, plan_stop

    plan_one = plan_start if which == "start" else plan_stop
    motion = options.motion or MotionOptions()
    failure: UnsolvedError | None = None
    for stretch in STRETCHES:
        longer = replace(motion, stand_seconds=stretch * motion.stand_seconds)
        try:
            with watch.stage("motion"):
                plan = plan_one(robot, gait, name=name or which, options=longer)
        except UnsolvedError as error:
            failure = failure or error
            watch.progress("motion", f"{name or which} of {longer.stand_seconds:.2f} s: left ({error})")
            continue
        watch.progress("motion", f"{plan.name}: {plan.duration:.2f} s, {plan.report.seconds:.2f} s to solve")
        return plan
    assert failure is not None
    raise failure
