"""`verify_timeline`: run a timeline in a simulator and judge every segment of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from gaitforge.motion.timeline import Timeline
from gaitforge.robot.model import RobotModel
from gaitforge.task.scene import Scene
from gaitforge.verify.both import Both
from gaitforge.verify.checks import ALL, CheckLimits, Segment, SegmentCheck
from gaitforge.verify.checks.travel import travel
from gaitforge.verify.default import default_simulator
from gaitforge.verify.simulator import Progress, Simulator
from gaitforge.verify.trace import Trace
from gaitforge.verify.verdict import Check, Verdict


def verify_timeline(
    robot: RobotModel,
    timeline: Timeline,
    scene: Scene | None = None,
    simulator: Simulator | Both | None = None,
    limits: CheckLimits | None = None,
    progress: Progress | None = None,
) -> Verdict:
    """Execute the timeline in a simulator (None: `default_simulator`), or in two, and judge it.

    What the robot carries in every segment alike is simulated as part of it; loads that come and go are
    bodies of the scene.  `progress` is called with the fraction done.  SimulationError when the simulator refuses the
    robot; a robot that falls is no error but a verdict.
    """
    robot = _laden(robot, timeline)
    runners = simulator.simulators if isinstance(simulator, Both) else (simulator or default_simulator(),)
    verdicts = []
    for turn, runner in enumerate(runners):
        trace = runner.run(robot, timeline, scene or Scene(), _share(progress, turn, len(runners)))
        verdicts.append(judge(robot, timeline, trace, runner.name, limits))
    return together(verdicts)


def together(verdicts: Sequence[Verdict]) -> Verdict:
    """One verdict of several about the same timeline: the first one's trace, everybody's checks."""
    first, *others = verdicts
    return replace(first, checks=tuple(c for v in verdicts for c in v.checks), others=tuple(others))


def _share(progress: Progress | None, turn: int, turns: int) -> Progress | None:
    """Progress of one of several runs as part of the whole."""
    if progress is None:
        return None
    return lambda fraction: progress((turn + fraction) / turns)


def _laden(robot: RobotModel, timeline: Timeline) -> RobotModel:
    carried = {entry.plan.loads for entry in timeline.entries}
    return robot.carrying(*carried.pop()) if len(carried) == 1 else robot


def judge(
    robot: RobotModel,
    timeline: Timeline,
    trace: Trace,
    simulator: str,
    limits: CheckLimits | None = None,
    checks: Sequence[SegmentCheck] = ALL,
) -> Verdict:
    """The verdict on a trace, from whichever simulator it came."""
    segments = [Segment(robot, timeline, trace, entry, limits or CheckLimits()) for entry in timeline.entries]
    found = [
        Check(check.name, segment.entry.plan.name, simulator, f.value, f.limit, f.unit, f.passed)
        for segment in segments
        for check in checks
        if (f := check.find(segment)) is not None
    ]
    speeds = tuple(travel(segment).speed for segment in segments)
    return Verdict(simulator, tuple(found), trace, timeline, speeds)
