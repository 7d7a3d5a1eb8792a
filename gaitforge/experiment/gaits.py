"""Gaits as data, each planned once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from gaitforge.errors import InputError, Problem
from gaitforge.pipeline.options import Options
from gaitforge.pipeline.stopwatch import Stopwatch
from gaitforge.robot.model import RobotModel
from gaitforge.task.load import load_task
from gaitforge.task.phase import Phase
from gaitforge.task.scene import Scene

if TYPE_CHECKING:
    from gaitforge.motion.plan import MotionPlan


@lru_cache(maxsize=8)
def robot_called(name: str) -> RobotModel:
    """The robot; one for all jobs of a process, because it keeps what was compiled for it."""
    from gaitforge.robot.load import load_robot

    return load_robot(name)


@dataclass(frozen=True)
class GaitCase:
    """One gait of one robot."""

    robot: str
    phase: Phase


@dataclass(frozen=True, eq=False)
class PlannedGait:
    """A gait, and how the robot starts it from a stand."""

    plan: MotionPlan
    start: MotionPlan
    seconds: float
    """[s] for both"""


def read_gaits(robot: str, gaits: Mapping[str, Any], file: str) -> dict[str, GaitCase]:
    """Name → gait, from the data of a task's phases (docs/how_to_add_a_task.md).

    ``free: [L1, R1]`` is short for roles of limbs that are held.  Raises `InputError` with all problems.
    """
    phases = {name: _phase(dict(data or {}), f"{robot}.{name}", file) for name, data in gaits.items()}
    task = load_task({"phases": phases}, robot, robot=robot_called(robot), file=f"{file}: {robot}")
    return {phase.name: GaitCase(robot, phase) for phase in task.phases}


def _phase(data: dict[str, Any], key: str, file: str) -> dict[str, Any]:
    free = data.pop("free", [])
    if not isinstance(free, list | tuple):
        raise InputError(Problem(file, f"{key}.free", repr(free), "a list of limbs"))
    return {**data, "roles": {**{str(limb): "held" for limb in free}, **dict(data.get("roles") or {})}}


def plan_gait_case(case: GaitCase, options: Options) -> PlannedGait:
    """The gait and its start; errors as those of the pipeline's `plan_phase`."""
    from gaitforge.motion.stand import plan_start
    from gaitforge.pipeline.search.gaits import plan_phase

    robot, watch = robot_called(case.robot), Stopwatch()
    plan = plan_phase(robot, case.phase, Scene(), options, watch).plan
    return PlannedGait(plan, plan_start(robot, plan, options=options.motion), watch.timings()["total"])
