"""One transition between two gaits: planned once, executed and judged in every simulator."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

from gaitforge.errors import UnsolvedError
from gaitforge.experiment.experiment import Row, Tools
from gaitforge.experiment.gaits import GaitCase, PlannedGait, robot_called
from gaitforge.experiment.judged import change_row
from gaitforge.pipeline.stopwatch import Stopwatch
from gaitforge.task.scene import Scene

if TYPE_CHECKING:
    from gaitforge.motion.plan import MotionPlan
    from gaitforge.motion.timeline import Timeline
    from gaitforge.pipeline.options import Options
    from gaitforge.pipeline.search.segment import Segment


@dataclass(frozen=True, eq=False)
class ChangeJob:
    """Start, gait a, the transition, gait b.

    The first gait is left where that is best; where the robot cannot start the gait as it is begun then, it is left at
    its own seam.  The run ends while it walks.
    """

    before: GaitCase
    after: GaitCase
    method: Literal["optimise", "interpolate"]
    cycles: tuple[int, int] = (2, 2)
    """Of the gaits before and after."""
    phases: Literal["seam", "paper", "best"] = "best"
    """Where in their cycles an optimised transition joins the gaits"""
    published_m_s: float | None = None
    """Speed that the literature gives for this transition [m/s]"""
    plans: tuple[PlannedGait | Exception, PlannedGait | Exception] | None = None
    """Both gaits, or why there is none."""

    @property
    def key(self) -> str:
        """``robot.before_to_after.method``"""
        return f"{self.before.robot}.{self.before.phase.name}_to_{self.after.phase.name}.{self.method}"

    @property
    def case(self) -> Row:
        """What identifies the rows."""
        return {
            "robot": self.before.robot,
            "before": self.before.phase.name,
            "after": self.after.phase.name,
            "method": self.method,
            "published_m_s": self.published_m_s,
        }

    def measure(self, tools: Tools) -> Sequence[Row]:
        """One row a simulator; errors of planning leave this function."""
        from gaitforge.verify.verify import verify_timeline

        begin = time.perf_counter()
        change, timeline = self._planned(tools)
        planning = time.perf_counter() - begin
        rows = []
        for name, simulator in tools.simulators.items():
            verdict = verify_timeline(
                timeline.robot, timeline, Scene(), simulator=simulator, limits=tools.options.limits
            )
            rows.append({**self.case, "simulator": name, **change_row(verdict, change), "plan_s": planning})
            if tools.logs is not None:
                tools.logs.mkdir(parents=True, exist_ok=True)
                tools.options.recorder.write(tools.logs / f"{self.key}.{name}.mcap", timeline.robot, verdict)
        return rows

    def _planned(self, tools: Tools) -> tuple[Segment, Timeline]:
        from gaitforge.motion.timeline_build import build_timeline

        assert self.plans is not None
        for plan in self.plans:
            if isinstance(plan, Exception):
                raise plan
        old, new = (plan for plan in self.plans if isinstance(plan, PlannedGait))
        search = replace(tools.options.search, transition_phases=self.phases)
        options = replace(tools.options, transition=self.method, search=search)
        try:
            change, parts = self._joined(old, new, options, None)
        except UnsolvedError:
            change, parts = self._joined(old, new, options, 0)
        return change, build_timeline(robot_called(self.before.robot), parts, Scene())

    def _joined(
        self, old: PlannedGait, new: PlannedGait, options: Options, leave: int | None
    ) -> tuple[Segment, list[tuple[MotionPlan, int]]]:
        from gaitforge.motion.stand import plan_start
        from gaitforge.pipeline.search.transitions import meeting, plan_change

        robot = robot_called(self.before.robot)
        change = plan_change(robot, old.plan, new.plan, options, Stopwatch(), leave=leave)
        before, after = meeting(old.plan, new.plan, change.plan.pattern, options)
        same = before is old.plan or change.plan.pattern.info.get("from_column") == 0
        start = old.start if same else plan_start(robot, before, options=options.motion)
        first, last = self.cycles
        return change, [(start, 1), (before, first), (change.plan, 1), (after, last)]
