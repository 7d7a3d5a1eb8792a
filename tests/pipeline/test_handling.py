"""Tasks that pick up and put down, planned as a whole."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

from gaitforge.errors import UnsolvedError
from gaitforge.motion.manipulation.regroup import AMPLE
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.still import static_margin
from gaitforge.motion.timeline import place
from gaitforge.motion.timeline_build import laid_out, last_pose
from gaitforge.pipeline.handling import Carriage
from gaitforge.pipeline.options import Options
from gaitforge.pipeline.schedule import plan_task
from gaitforge.pipeline.search.refusals import Refusal, _identity_of, why_refused
from gaitforge.pipeline.search.segment import Segment
from gaitforge.pipeline.stopwatch import Stopwatch
from gaitforge.robot.load import load_robot
from gaitforge.robot.rotation import matrices
from gaitforge.task.load import load_task

TASKS = Path(__file__).parents[2] / "conf" / "task"


def planned(cycles: int, task: str = "carry_middle") -> list[Segment]:
    data = yaml.safe_load((TASKS / f"{task}.yaml").read_text())
    data["phases"][1]["cycles"] = cycles
    robot = load_robot("hexapod")
    options = Options(simulator=None, recorder=None, motion=MotionOptions(explain=False))  # type: ignore[arg-type]
    done: list[Segment] = []
    plan_task(robot, load_task(data, task, robot=robot), options, Stopwatch(), done)
    return done


def test_a_box_is_put_down_where_the_shelf_is() -> None:
    segments = planned(4)
    names = [s.plan.name for s in segments]
    assert names == [
        "box_reach", "box_close", "box_lift", "start", "carry", "stop", "box_lower", "box_open", "box_retract",
    ]  # fmt: skip
    (gait,) = (s.plan for s in segments if s.plan.kind == "gait")
    assert gait.command.step_height is None
    swing = gait.feet[:, [gait.pattern.limbs.index("L1")], 2].max() - gait.feet[:, :, 2].min()
    assert swing >= 0.04 - 1e-6  # a third higher than a hexapod's nominal 3 cm


def test_a_box_that_would_come_down_beside_the_shelf_is_told() -> None:
    with pytest.raises(UnsolvedError, match=r"box_open: the middle of box comes to be \d+ mm beyond the edge of rest"):
        planned(2)


@pytest.fixture(scope="module")
def twice() -> list[Segment]:
    return planned(2, "carry_both")


def test_who_has_let_go_of_a_box_stands_on_other_limbs_and_takes_the_next_one(twice: list[Segment]) -> None:
    plans = [s.plan for s in twice]
    between = next(k for k, plan in enumerate(plans) if plan.kind == "transition")
    before, move, after = plans[between - 1 : between + 2]
    assert (before.name, after.name) == ("box_retract", "tray_reach")
    for end, begin in ((before, move), (move, after)):
        np.testing.assert_allclose(end.joint_positions[:, -1], begin.joint_positions[:, 0], atol=1e-6)
        np.testing.assert_allclose(end.base_poses[-1, 2:], begin.base_poses[0, 2:], atol=1e-6)
    np.testing.assert_allclose(move.base_poses[-1, :2], move.base_poses[0, :2], atol=1e-5)
    walking = [plan.pattern.locomotive for plan in plans if plan.kind == "gait"]
    assert walking == [("L2", "L3", "R2", "R3"), ("L1", "L3", "R1", "R3")]
    assert float(move.report.details["zmp_margin_m"]) >= 0.008


def test_a_way_between_two_loads_that_simulation_refused_gives_way_to_another(twice: list[Segment]) -> None:
    robot = load_robot("hexapod")
    k = next(k for k, segment in enumerate(twice) if segment.plan.kind == "transition")
    stood, way, ready = (segment.plan for segment in twice[k - 1 : k + 2])
    assert static_margin(robot, way) >= AMPLE
    refusal = Refusal(way.name, _identity_of(way), "slip")
    options = Options(simulator=None, recorder=None, refused=(refusal,))  # type: ignore[arg-type]
    (other,) = Carriage._regrouped(robot, stood, ready, options, Stopwatch())
    assert other.plan.name == way.name
    assert why_refused(other.plan, options.refused) is None
    assert static_margin(robot, other.plan) >= AMPLE


def test_the_second_load_is_grasped_where_the_scene_has_it(twice: list[Segment]) -> None:
    entries = laid_out([(s.plan, s.cycles) for s in twice])
    for name, xyz in (("box_close", (0.33, 0.0, 0.06)), ("tray_close", (0.3, 0.0, 0.4278))):
        entry = next(e for e in entries if e.plan.name == name)
        base = place(entry.plan.base_poses[-1:], entry.origin)[0]
        found = base[:3] + matrices(base[3:]) @ entry.plan.holdings[0].poses[-1, :3]
        np.testing.assert_allclose(found, xyz, atol=2e-4)


def test_a_robot_that_carries_looks_where_it_walks(twice: list[Segment]) -> None:
    entries = {e.plan.name: e for e in laid_out([(s.plan, s.cycles) for s in twice])}
    for name in ("stop", "carry_tray_stop"):
        assert last_pose(entries[name])[5] == pytest.approx(0.0, abs=1e-6)
