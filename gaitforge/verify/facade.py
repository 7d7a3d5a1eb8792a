"""`verify`: a list of motion plans put to the test, as a notebook would ask for it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import count
from typing import Any, Literal

from gaitforge.errors import InputError, Problem
from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.stand import plan_start, plan_stop
from gaitforge.motion.timeline_build import build_timeline
from gaitforge.robot.model import RobotModel
from gaitforge.task.scene import Scene, SceneObject
from gaitforge.verify.both import Both
from gaitforge.verify.checks import CheckLimits
from gaitforge.verify.mujoco import MujocoSimulator
from gaitforge.verify.pybullet import PyBulletSimulator
from gaitforge.verify.simulator import Progress, Simulator
from gaitforge.verify.verdict import Verdict
from gaitforge.verify.verify import verify_timeline

SIMULATORS = {"pybullet": PyBulletSimulator, "mujoco": MujocoSimulator, "both": Both}


def verify(
    robot: RobotModel,
    segments: Sequence[tuple[MotionPlan, int]],
    *,
    scene: Scene | Sequence[SceneObject | Mapping[str, Any]] = (),
    simulator: Literal["pybullet", "mujoco", "both"] | Simulator | Both | None = None,
    limits: CheckLimits | None = None,
    stands: bool = True,
    progress: Progress | None = None,
) -> Verdict:
    """Simulate (plan, cycles) pairs one after the other and judge every one of them.

    A robot starts and stops standing: where the list does not begin or end with a stand, one is
    planned and added, unless `stands` is False.  `scene`: objects around the robot, as `SceneObject`
    or as a mapping of its fields [m, rad].  `simulator`: a name takes its default settings; None is
    PyBullet, or MuJoCo where PyBullet is not installed; with *both* the robot passes when it does in each, and
    every check names its simulator.

    Raises `InputError` for an empty list, an unknown simulator or tool targets that the scene does not
    have, and `SimulationError` when the simulator refuses the robot; a robot that falls is no error
    but a verdict.
    """
    if not segments:
        raise InputError(Problem("verify", "segments", "an empty list", "at least one (plan, cycles)"))
    if isinstance(simulator, str) and simulator not in SIMULATORS:
        raise InputError(Problem("verify", "simulator", repr(simulator), "one of " + ", ".join(SIMULATORS)))
    around = scene if isinstance(scene, Scene) else Scene(tuple(_scene_object(item) for item in scene))
    whole = _with_stands(robot, segments) if stands else segments
    timeline = build_timeline(robot, _named_apart(whole), around)
    runner = SIMULATORS[simulator]() if isinstance(simulator, str) else simulator
    return verify_timeline(robot, timeline, around, simulator=runner, limits=limits, progress=progress)


def _with_stands(robot: RobotModel, segments: Sequence[tuple[MotionPlan, int]]) -> list[tuple[MotionPlan, int]]:
    whole = list(segments)
    if whole[0][0].kind == "gait":
        whole.insert(0, (plan_start(robot, whole[0][0]), 1))
    if whole[-1][0].kind == "gait":
        whole.append((plan_stop(robot, whole[-1][0]), 1))
    return whole


def _named_apart(segments: Sequence[tuple[MotionPlan, int]]) -> list[tuple[MotionPlan, int]]:
    """Plans of one name get a number, so that checks and logs tell them apart: gait, gait-2, …"""
    taken: set[str] = set()
    apart = []
    for plan, cycles in segments:
        names = (plan.name if n == 1 else f"{plan.name}-{n}" for n in count(1))
        name = next(n for n in names if n not in taken)
        taken.add(name)
        apart.append((plan if name == plan.name else replace(plan, name=name), cycles))
    return apart


def _scene_object(item: SceneObject | Mapping[str, Any]) -> SceneObject:
    if isinstance(item, SceneObject):
        return item
    try:
        return SceneObject(**item)
    except TypeError as error:
        expected = "the fields of gaitforge.SceneObject"
        raise InputError(Problem("verify", "scene", str(error), expected)) from error
