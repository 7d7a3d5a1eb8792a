"""Two simulators on one timeline: both must agree to pass, and where they do not is told."""

from dataclasses import replace

import numpy as np
import pytest
from walkers import perfect_trace, stand_plan, timeline_of, walker

import gaitforge as gf
from gaitforge.errors import InputError
from gaitforge.motion.timeline import Timeline
from gaitforge.robot.model import RobotModel
from gaitforge.task.scene import Scene
from gaitforge.verify.agreement import disagreements, opinions
from gaitforge.verify.both import Both
from gaitforge.verify.mujoco import MujocoSimulator
from gaitforge.verify.pybullet import PyBulletSimulator
from gaitforge.verify.trace import Trace
from gaitforge.verify.verdict import Verdict
from gaitforge.verify.verify import judge, together, verify_timeline

SIX = walker(3)
TIMELINE = timeline_of(SIX, (stand_plan(SIX, 0.5), 1))


def verdict(simulator: str, tilt_deg: float = 0.0, faster: float = 0.0) -> Verdict:
    """A run that went as planned but for a tilt at its end and a drift forward [m/s]."""
    trace = perfect_trace(SIX, TIMELINE)
    poses = trace.base_poses.copy()
    poses[-1, 4] += np.radians(tilt_deg)
    poses[:, 0] += faster * trace.times
    return judge(SIX, TIMELINE, replace(trace, base_poses=poses), simulator)


def test_a_robot_that_stands_stands_in_both() -> None:
    told: list[float] = []
    found = verify_timeline(SIX, TIMELINE, simulator=Both(), progress=told.append)
    assert found.passed
    assert found.simulators == ("pybullet", "mujoco")
    assert {check.simulator for check in found.checks} == {"pybullet", "mujoco"}
    assert len(found.checks) == 2 * len(found.others[0].checks)
    assert told == sorted(told)
    assert told[-1] == 1.0


def test_the_trace_that_is_kept_is_that_of_the_simulator_that_is_named() -> None:
    found = verify_timeline(SIX, TIMELINE, simulator=Both())
    alone = PyBulletSimulator().run(SIX, TIMELINE, Scene())
    assert found.simulator == "pybullet"
    np.testing.assert_array_equal(found.trace.base_poses, alone.base_poses)
    second = MujocoSimulator().run(SIX, TIMELINE, Scene())
    np.testing.assert_array_equal(found.others[0].trace.base_poses, second.base_poses)


@pytest.mark.parametrize(("here", "there"), [(0.0, 6.0), (6.0, 0.0)])
def test_one_that_fails_is_enough_and_is_named(here: float, there: float) -> None:
    found = together([verdict("pybullet", here), verdict("mujoco", there)])
    assert not found.passed
    said = opinions(found)
    assert said is not None
    assert said["passed"] == {"pybullet": here == 0.0, "mujoco": there == 0.0}
    (differ,) = said["disagreements"]
    assert (differ["name"], differ["segment"]) == ("tilt", "stand")
    assert differ["passed"] == said["passed"]
    assert differ["values"] == pytest.approx({"pybullet": here, "mujoco": there})


def test_two_that_fail_alike_agree() -> None:
    found = together([verdict("pybullet", 5.0), verdict("mujoco", 6.0)])
    assert not found.passed
    assert disagreements(found.checks) == ()


def test_speeds_are_compared_and_never_averaged() -> None:
    found = together([verdict("pybullet", faster=0.001), verdict("mujoco", faster=0.003)])
    said = opinions(found)
    assert said is not None
    (speed,) = said["speeds_m_s"]
    assert speed["values"] == pytest.approx({"pybullet": 0.001, "mujoco": 0.003})
    assert speed["difference"] == pytest.approx(0.002)
    assert found.speeds == found.others[0].speeds or found.speeds[0] == pytest.approx(0.001)


def test_a_segment_that_comes_twice_is_compared_turn_by_turn() -> None:
    twice = timeline_of(SIX, (stand_plan(SIX, 0.5), 1), (stand_plan(SIX, 0.5), 1))
    fine = perfect_trace(SIX, twice)
    tilted = fine.base_poses.copy()
    tilted[-1, 4] += np.radians(6.0)
    first = judge(SIX, twice, fine, "pybullet")
    second = judge(SIX, twice, replace(fine, base_poses=tilted), "mujoco")
    (found,) = disagreements(together([first, second]).checks)
    assert [answer.passed for answer in found.answers] == [True, False]
    assert str(found) == "tilt of stand: pybullet 0 deg holds, mujoco 6 deg fails"


def test_one_simulator_alone_gives_no_opinions() -> None:
    assert opinions(verdict("pybullet")) is None


def test_the_python_names_of_the_simulators_are_those_of_the_command_line() -> None:
    plans = [(stand_plan(SIX, 0.2), 1)]
    assert gf.verify(SIX, plans, simulator="mujoco").simulators == ("mujoco",)
    assert gf.verify(SIX, plans, simulator="both").simulators == ("pybullet", "mujoco")
    with pytest.raises(InputError, match="one of pybullet, mujoco, both"):
        gf.verify(SIX, plans, simulator="gazebo")  # type: ignore[arg-type]


def test_a_simulator_of_ones_own_is_asked_like_any_other() -> None:
    class Perfect:
        name = "perfect"

        def run(self, robot: RobotModel, timeline: Timeline, scene: Scene, progress: object = None) -> Trace:
            return perfect_trace(robot, timeline)

    found = gf.verify(SIX, [(stand_plan(SIX, 0.2), 1)], simulator=Perfect())
    assert found.passed
    assert {check.simulator for check in found.checks} == {"perfect"}
