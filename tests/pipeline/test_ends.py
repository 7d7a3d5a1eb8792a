"""How a walk comes to rest: at the end of a cycle, and where that has no plan, further on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import gaitforge as gf
from gaitforge.errors import UnsolvedError
from gaitforge.motion import stand
from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.rotate import rotated
from gaitforge.motion.timeline_build import build_timeline
from gaitforge.pipeline.options import Options
from gaitforge.pipeline.search.stands import plan_end
from gaitforge.pipeline.search.tries import unexplained
from gaitforge.pipeline.stopwatch import Stopwatch
from gaitforge.robot.model import RobotModel

OPTIONS = Options(simulator=None, recorder=None)  # type: ignore[arg-type]  # planning simulates and records nothing


@pytest.fixture(scope="module")
def robot() -> RobotModel:
    return gf.load_robot("hexapod")


@pytest.fixture(scope="module")
def gait(robot: RobotModel) -> MotionPlan:
    pattern = gf.FootfallPattern.from_rows(
        {"L1": "000111", "L2": "111000", "L3": "000111", "R1": "111000", "R2": "000111", "R3": "111000"}
    )
    return gf.plan_gait(robot, pattern, name="walk")


def blocked(monkeypatch: pytest.MonkeyPatch, known: dict[bytes, tuple[str, ...] | None]) -> list[float]:
    """Let stops from these first columns of a gait relax something, or have no plan; the times that were asked for."""
    real, asked = stand.plan_stop, list[float]()

    def stop(robot: RobotModel, gait: MotionPlan, *, name: str, options: gf.MotionOptions) -> MotionPlan:
        asked.append(options.stand_seconds)
        relaxed = known.get(gait.joint_positions[:, 0].tobytes(), ())
        if relaxed is None:
            raise UnsolvedError("a limb is in the way", {})
        return replace(real(robot, gait, name=name, options=options), relaxed=relaxed)

    monkeypatch.setattr(stand, "plan_stop", stop)
    return asked


def start_of(gait: MotionPlan, column: int) -> bytes:
    return gait.joint_positions[:, column * gait.samples_per_column].tobytes()


def stop_at(robot: RobotModel, gait: MotionPlan, column: int) -> MotionPlan:
    return stand.plan_stop(robot, rotated(gait, column), options=unexplained(None))


def test_a_walk_ends_with_its_cycle(robot: RobotModel, gait: MotionPlan) -> None:
    assert [s.plan.name for s in plan_end(robot, gait, OPTIONS, Stopwatch(), "stop")] == ["stop"]


def test_a_walk_that_cannot_stop_there_goes_on_to_the_column_where_it_stops_best(
    monkeypatch: pytest.MonkeyPatch, robot: RobotModel, gait: MotionPlan
) -> None:
    known = {start_of(gait, 0): None, start_of(gait, 1): ("slower",), start_of(gait, 2): None}
    ratios = {k: stop_at(robot, gait, k).report.details["effort_ratio"] for k in (3, 4, 5)}
    best = min(ratios, key=ratios.__getitem__)
    asked = blocked(monkeypatch, known)
    rest, stop = (s.plan for s in plan_end(robot, gait, OPTIONS, Stopwatch(), "stop"))
    assert len(set(asked)) == 1
    assert (rest.name, rest.pattern.columns) == ("walk_until_stop", best)
    np.testing.assert_array_equal(rest.pattern.contact, gait.pattern.contact[:, :best])
    assert len(set(ratios.values())) == 3
    timeline = build_timeline(robot, [(gait, 2), (rest, 1), (stop, 1)])
    for seam in (timeline.entries[1].start, timeline.entries[2].start):
        before, after = (timeline.sample([seam + s * 1e-5]) for s in (-1, 1))
        assert np.abs(after.joint_positions - before.joint_positions).max() < 1e-4
        assert np.abs(after.base_poses - before.base_poses).max() < 1e-5
        assert np.abs(after.joint_velocities - before.joint_velocities).max() < 1e-2


def test_a_walk_that_can_stop_nowhere_in_the_usual_time_is_given_more_or_less_of_it(
    monkeypatch: pytest.MonkeyPatch, robot: RobotModel, gait: MotionPlan
) -> None:
    known = dict.fromkeys((start_of(gait, k) for k in range(6)), None)
    asked = blocked(monkeypatch, known)
    with pytest.raises(UnsolvedError, match="in the way"):
        plan_end(robot, gait, OPTIONS, Stopwatch(), "stop")
    usual = gf.MotionOptions().stand_seconds
    assert asked[:7] == [usual] * 7
    assert max(asked[7:]) > 2.0 * usual > usual > min(asked[7:])
