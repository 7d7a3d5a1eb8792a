"""`verify_timeline`: run a timeline in a simulator and judge every segment of it."""

from __future__ import annotations

from collections.abc import Sequence

from gaitforge.motion.timeline import Timeline
from gaitforge.robot.model import RobotModel
from gaitforge.task.scene import Scene
from gaitforge.verify.checks import ALL, CheckLimits, Segment, SegmentCheck
from gaitforge.verify.checks.travel import travel
from gaitforge.verify.pybullet import PyBulletSimulator
from gaitforge.verify.simulator import Progress, Simulator
from gaitforge.verify.trace import Trace
from gaitforge.verify.verdict import Check, Verdict


def verify_timeline(
    robot: RobotModel,
    timeline: Timeline,
    scene: Scene | None = None,
    simulator: Simulator | None = None,
    limits: CheckLimits | None = None,
    progress: Progress | None = None,
) -> Verdict:
    """Execute the timeline in a simulator (PyBullet by default) and judge it.

    What the robot carries in every segment alike is simulated as part of it; loads that come and go are
    bodies of the scene.  `progress` is called with the fraction done.  SimulationError when the simulator refuses the
    robot; a robot that falls is no error but a verdict.
    """
    robot = _laden(robot, timeline)
    runner = simulator or PyBulletSimulator()
    trace = runner.run(robot, timeline, scene or Scene(), progress)
    return judge(robot, timeline, trace, runner.name, limits)


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
