"""One subset of limbs lost: planned, executed and judged in every simulator, or proven impossible."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

from gaitforge.errors import InfeasibleError
from gaitforge.experiment.experiment import Row, Tools
from gaitforge.experiment.gaits import robot_called
from gaitforge.pipeline.stopwatch import Stopwatch
from gaitforge.task.phase import Failure, Phase, Task
from gaitforge.task.roles import Mode
from gaitforge.task.scene import Scene

if TYPE_CHECKING:
    from gaitforge.pipeline.options import Options
    from gaitforge.pipeline.search.segment import Segment
    from gaitforge.robot.model import RobotModel
    from gaitforge.verify.verdict import Verdict

BEFORE, AFTER = "all", "without"


@dataclass(frozen=True)
class LossJob:
    """Walk, lose limbs at a seeded moment, halt, walk on."""

    robot: str
    limbs: tuple[str, ...]
    mode: Mode
    cycles: tuple[int, int] = (1, 4)
    """Of the gaits before and after"""
    seed: int = 0

    @property
    def key(self) -> str:
        """``robot.limbs.mode``"""
        return f"{self.robot}.{'-'.join(self.limbs)}.{self.mode}"

    @property
    def case(self) -> Row:
        """What identifies the rows."""
        return {"robot": self.robot, "limbs": " ".join(self.limbs), "lost": len(self.limbs), "mode": self.mode}

    @property
    def task(self) -> Task:
        """The task of the command line's ``task=limb_failure``."""
        before, after = self.cycles
        first = Phase(BEFORE, cycles=before, failure=Failure(self.limbs, self.mode))
        return Task("limb_failure", (first, Phase(AFTER, cycles=after)))

    def measure(self, tools: Tools) -> Sequence[Row]:
        """One row a simulator, or a single one with the proof that nothing can walk."""
        from gaitforge.pipeline.proving import proven
        from gaitforge.pipeline.schedule import plan_task

        begin, done = time.perf_counter(), list["Segment"]()
        robot, options = robot_called(self.robot), replace(tools.options, seed=self.seed)
        try:
            plan_task(robot, self.task, options, Stopwatch(), done)
        except InfeasibleError as error:
            proof = "{" + ", ".join(error.explain.get("families", ())) + "}"
            return [{**self.case, "status": error.status, "proof": proof, "verified": False, "settled": True}]
        planning = time.perf_counter() - begin
        rows = []
        for name, simulator in tools.simulators.items():
            execute = partial(_executed, robot, replace(options, simulator=simulator))
            found = proven(robot, self.task, options, Stopwatch(), done, execute)
            first = {"plans": len(found.verdicts), "first_failed": _failed(found.verdicts[0]), "plan_s": planning}
            rows.append({**self.case, "simulator": name, **loss_row(found.verdict, found.segments), **first})
            if tools.logs is not None:
                tools.logs.mkdir(parents=True, exist_ok=True)
                options.recorder.write(tools.logs / f"{self.key}.{name}.mcap", robot, found.verdict)
        return rows


def _executed(robot: RobotModel, options: Options, segments: Sequence[Segment]) -> Verdict:
    from gaitforge.motion.timeline_build import build_timeline
    from gaitforge.verify.verify import verify_timeline

    timeline = build_timeline(robot, [(s.plan, s.cycles) for s in segments], Scene())
    return verify_timeline(robot, timeline, Scene(), simulator=options.simulator, limits=options.limits)


def _failed(verdict: Verdict) -> list[str]:
    return [f"{c.segment}: {c.name} {c.value:.3g} {c.unit}" for c in verdict.failed]


def loss_row(verdict: Verdict, done: Sequence[Segment]) -> dict[str, Any]:
    """Values of the gait after the failure; *fallen* and *verified* speak of the whole run."""
    index, gait = next((i, s) for i, s in enumerate(done) if s.plan.name == AFTER)
    until = next((s.plan for s in done if s.plan.name == f"{BEFORE}_until_failure"), None)
    whole = next(s.plan for s in done if s.plan.name == BEFORE)
    here = {c.name: c.value for c in verdict.checks if c.segment == AFTER}
    unsupported = [c.value for c in verdict.checks if c.name == "unsupported"]
    fallen = [c for c in verdict.checks if c.name == "fallen"]
    return {
        "status": "verified" if verdict.passed else "unverified",
        "verified": verdict.passed,
        "settled": verdict.passed,
        "at": 0.0 if until is None else until.duration / whole.duration,
        "fallen": not all(c.passed for c in fallen),
        "speed_m_s": verdict.speeds[index],
        "speed_planned_m_s": gait.plan.speed,
        "margin_m": here["static_margin"] / 1000.0,
        "unsupported_s": max(unsupported, default=0.0),
        "tilt_worst_deg": max(c.value for c in fallen),
        "failed": _failed(verdict),
        "source": gait.plan.pattern.source,
        "columns": gait.plan.pattern.columns,
        "relaxed": [text for s in done for text in (*s.plan.pattern.relaxed, *s.plan.relaxed)],
        "tries": [f"{s.plan.name}: {len(s.left)}" for s in done if s.left],
    }
