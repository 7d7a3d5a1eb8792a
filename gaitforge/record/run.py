"""`Run`: what every channel reads; the trace thinned to the log's rate, with its stamps."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.timeline import Timeline
from gaitforge.record.tree import LinkTree
from gaitforge.robot.limbs import ToolMount
from gaitforge.robot.model import RobotModel
from gaitforge.task.scene import Scene
from gaitforge.verify.feet import CONTACT_N
from gaitforge.verify.trace import Trace
from gaitforge.verify.verdict import Verdict


@dataclass(frozen=True, eq=False)
class Run:
    """A verified run and how it is to be logged."""

    robot: RobotModel
    verdict: Verdict
    scene: Scene = field(default_factory=Scene)
    start_time_ns: int = 0
    """[ns] T0: what t = 0 is stamped with"""
    rate_hz: float = 50.0
    """[1/s] of states"""
    scene_hz: float = 25.0
    """[1/s] of drawings"""

    @property
    def trace(self) -> Trace:
        """What the simulator saw."""
        return self.verdict.trace

    @property
    def timeline(self) -> Timeline:
        """What was planned."""
        return self.verdict.timeline

    def stamp(self, time: float) -> int:
        """[ns] log time of the simulated time `time` [s]."""
        return self.start_time_ns + round(float(time) * 1e9)

    @cached_property
    def rows(self) -> NDArray[np.intp]:
        """Rows of the trace at `rate_hz`."""
        return self._every(self.rate_hz)

    @cached_property
    def scene_rows(self) -> NDArray[np.intp]:
        """Rows of the trace at `scene_hz`."""
        return self._every(min(self.scene_hz, self.rate_hz))

    @cached_property
    def contact(self) -> NDArray[np.bool_]:
        """(n, n_F) feet that press on the ground, at every row of the trace."""
        return np.asarray(self.trace.normal_force > CONTACT_N)

    @cached_property
    def camera(self) -> ToolMount | None:
        """The camera that took the trace's pictures; None where there are none."""
        if not self.trace.images:
            return None
        return next((tool for tool in self.robot.tools if tool.kind == "camera"), None)

    @property
    def camera_frame(self) -> str:
        """Of the pictures: z ahead, x right, y down."""
        return f"{self.camera.name}_optical" if self.camera else self.robot.base_link

    @cached_property
    def tree(self) -> LinkTree:
        """The robot's links."""
        return LinkTree.of(self.robot.urdf)

    def _every(self, rate: float) -> NDArray[np.intp]:
        times = self.trace.times
        wanted = np.arange(times[0], times[-1] + 1e-9, 1.0 / rate)
        after = np.clip(np.searchsorted(times, wanted - 1e-9), 0, len(times) - 1)
        return np.unique(after).astype(np.intp)
