"""Tasks that pick up and put down, planned as a whole."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from gaitforge.errors import UnsolvedError
from gaitforge.motion.options import MotionOptions
from gaitforge.pipeline.options import Options
from gaitforge.pipeline.schedule import plan_task
from gaitforge.pipeline.segment import Segment
from gaitforge.pipeline.stopwatch import Stopwatch
from gaitforge.robot.load import load_robot
from gaitforge.task.load import load_task

TASK = Path(__file__).parents[2] / "conf" / "task" / "carry_middle.yaml"


def planned(cycles: int) -> list[Segment]:
    data = yaml.safe_load(TASK.read_text())
    data["phases"][1]["cycles"] = cycles
    robot = load_robot("hexapod")
    options = Options(simulator=None, recorder=None, motion=MotionOptions(explain=False))  # type: ignore[arg-type]
    done: list[Segment] = []
    plan_task(robot, load_task(data, "carry_middle", robot=robot), options, Stopwatch(), done)
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
