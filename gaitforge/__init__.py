"""gaitforge: from a handful of robot modules to a walking, working robot in seconds.

What the command line does, a program or a notebook does with the names of this page; everything
behind them is imported when it is first used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from gaitforge import errors

if TYPE_CHECKING:
    from gaitforge.footfall.pattern import FootfallPattern as FootfallPattern
    from gaitforge.footfall.synthesis import synthesize_gait_pattern as synthesize_gait_pattern
    from gaitforge.footfall.synthesis import synthesize_transition_pattern as synthesize_transition_pattern
    from gaitforge.motion.gait import plan_gait as plan_gait
    from gaitforge.motion.options import MotionOptions as MotionOptions
    from gaitforge.motion.plan import MotionPlan as MotionPlan
    from gaitforge.motion.stand import plan_start as plan_start
    from gaitforge.motion.stand import plan_stop as plan_stop
    from gaitforge.motion.transition import plan_transition as plan_transition
    from gaitforge.pipeline.recover import Recovery as Recovery
    from gaitforge.pipeline.recover import recover as recover
    from gaitforge.record import write_log as write_log
    from gaitforge.robot.load import load_robot as load_robot
    from gaitforge.robot.model import RobotModel as RobotModel
    from gaitforge.robot.payload import Load as Load
    from gaitforge.task.roles import Failed as Failed
    from gaitforge.task.roles import Held as Held
    from gaitforge.task.roles import Tool as Tool
    from gaitforge.task.scene import Scene as Scene
    from gaitforge.task.scene import SceneObject as SceneObject
    from gaitforge.verify.facade import verify as verify
    from gaitforge.verify.verdict import Verdict as Verdict

__version__ = "0.1.0"

_HOMES = {
    "load_robot": "gaitforge.robot.load",
    "RobotModel": "gaitforge.robot.model",
    "FootfallPattern": "gaitforge.footfall.pattern",
    "synthesize_gait_pattern": "gaitforge.footfall.synthesis",
    "synthesize_transition_pattern": "gaitforge.footfall.synthesis",
    "MotionOptions": "gaitforge.motion.options",
    "MotionPlan": "gaitforge.motion.plan",
    "plan_gait": "gaitforge.motion.gait",
    "plan_transition": "gaitforge.motion.transition",
    "plan_start": "gaitforge.motion.stand",
    "plan_stop": "gaitforge.motion.stand",
    "recover": "gaitforge.pipeline.recover",
    "Recovery": "gaitforge.pipeline.recover",
    "Load": "gaitforge.robot.payload",
    "Failed": "gaitforge.task.roles",
    "Held": "gaitforge.task.roles",
    "Tool": "gaitforge.task.roles",
    "Scene": "gaitforge.task.scene",
    "SceneObject": "gaitforge.task.scene",
    "verify": "gaitforge.verify.facade",
    "Verdict": "gaitforge.verify.verdict",
    "write_log": "gaitforge.record",
}
__all__ = ["__version__", "errors", *_HOMES]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'gaitforge' has no attribute {name!r}")
    if name == "verify":  # the package and the function share the name: the package can be called
        return import_module("gaitforge.verify")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
