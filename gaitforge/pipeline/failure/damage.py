"""The robot as it is while a task goes on: whole at first, then with what has failed so far."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion.plan import MotionPlan
from gaitforge.pipeline.options import Options
from gaitforge.robot.model import RobotModel
from gaitforge.task.phase import Task
from gaitforge.task.roles import Failed

SPEEDS = (1.0, 0.7, 0.5)
"""Shares of the speed asked for that are tried in this order once limbs have failed."""


@dataclass(frozen=True, eq=False)
class Damage:
    """The robot as it is while a task goes on: whole at first, then with what has failed so far."""

    robot: RobotModel
    """Failed limbs have their posture where held ones have theirs"""
    options: Options
    """Failed limbs are kept off the ground"""
    roles: Mapping[str, Failed] = field(default_factory=dict)
    """Limb → `Failed`"""
    stand: MotionPlan | None = None
    """The halt after which walking on begins; None before anything has failed"""
    clear: MotionPlan | None = None
    """The stand after it in which failed feet are off the ground; None where there is no need or no plan"""
    held: tuple[str, ...] = ()
    """Failed limbs that bear load at the end of the halt"""
    pattern: FootfallPattern | None = None
    """Of the gait in which limbs failed"""
    hung: bool = False
    """Limp limbs have been folded, and hang from a body that stands higher"""

    @property
    def speeds(self) -> tuple[float, ...]:
        """Shares of the speed asked for that may be tried."""
        return SPEEDS if self.roles else (1.0,)

    def applied(self, task: Task, first: int) -> Task:
        """The task in which failed limbs have their role from phase `first` on."""
        later = (replace(p, roles={**p.roles, **self.roles}) for p in task.phases[first:])
        return replace(task, phases=(*task.phases[:first], *later))


def stuck(robot: RobotModel, roles: Mapping[str, Failed]) -> RobotModel:
    """The robot with failed limbs where they are: patterns and gaits are planned around that posture."""
    held = robot.nominal.held_posture.copy()
    for name, role in roles.items():
        held[robot.joint_indices(robot.limb(name))] = role.posture
    return replace(robot, nominal=replace(robot.nominal, held_posture=held))


def kept_clear(robot: RobotModel, roles: Mapping[str, Failed], options: Options) -> Options:
    """The options with the feet of locked limbs kept off the ground in every segment; limp ones drag."""
    from gaitforge.motion.constraints.off_ground import OffGround
    from gaitforge.motion.failure.halt import CLEAR_M, foot_points
    from gaitforge.motion.options import MotionOptions

    motion = options.motion or MotionOptions()
    others = tuple(f for f in motion.constraints if not isinstance(f, OffGround))
    locked = tuple(n for n, role in roles.items() if role.mode == "locked")
    clear = OffGround(foot_points(robot, locked, robot.nominal.held_posture), CLEAR_M)
    return replace(options, motion=replace(motion, constraints=(*others, clear)), transition="optimise")
