"""What every simulator is to the rest: a name, and a run of a timeline in a scene."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from gaitforge.motion.timeline import Timeline
from gaitforge.robot.model import RobotModel
from gaitforge.task.scene import Scene
from gaitforge.verify.trace import Trace

Progress = Callable[[float], None]
"""Called with the fraction done, 0…1."""


class Simulator(Protocol):
    """A rigid-body simulator that executes a timeline."""

    @property
    def name(self) -> str:
        """As it stands in `Check.simulator`."""
        ...

    def run(self, robot: RobotModel, timeline: Timeline, scene: Scene, progress: Progress | None = None) -> Trace:
        """Execute the timeline; SimulationError when the simulator refuses the robot."""
        ...
