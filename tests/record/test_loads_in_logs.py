"""What a log keeps of loads: the grasp in the plan, and where the box was and was to be."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from run_by_hand import SCENE, make_verdict

from gaitforge.motion.manipulation.holding import Holding
from gaitforge.record import write_log
from gaitforge.record.reader import read_run
from gaitforge.robot.load import load_robot
from gaitforge.robot.payload import Load
from gaitforge.robot.rotation import quaternions
from gaitforge.task.roles import Carry
from gaitforge.task.scene import Scene, SceneObject

CARRIED = np.array([0.3, 0.1, 0.05, 0.0, 0.0, 0.4])
HELD = Holding("crate", CARRIED[None], ("L1", "R1"), {"L1_J1": 4.0}, 0.5)


def test_a_grasp_comes_back_and_the_box_is_drawn_where_it_was_and_where_it_was_to_be(tmp_path: Path) -> None:
    robot = load_robot("hexapod")
    verdict = make_verdict(robot)
    entries = [
        replace(
            e,
            plan=replace(e.plan, holdings=(HELD,), loads=(Load(0.5, (0.3, 0.1, 0.05)),), roles={"L1": Carry("crate")}),
        )
        for e in verdict.timeline.entries
    ]
    timeline = replace(verdict.timeline, entries=tuple(entries))
    times = verdict.trace.times
    plan = replace(timeline.sample(np.minimum(times, timeline.duration - 1e-9)), times=times)
    box = np.tile([5.0, 6.0, 7.0, *quaternions([0.1, 0.2, 0.3])], (len(times), 1))
    trace = replace(verdict.trace, plan=plan, objects={"crate": box})
    scene = Scene((*SCENE.objects, SceneObject("crate", "box", (1.0, 0.0, 0.1), size=(0.2, 0.3, 0.1), mass=0.5)))
    write_log(tmp_path / "run.mcap", robot, replace(verdict, timeline=timeline, trace=trace), scene=scene)
    log = read_run(tmp_path / "run.mcap")
    (back,) = log.timeline.entries[1].plan.holdings
    assert (back.object, back.limbs, back.efforts, back.mass) == ("crate", ("L1", "R1"), {"L1_J1": 4.0}, 0.5)
    assert np.array_equal(back.poses, CARRIED[None])
    assert log.timeline.entries[1].plan.loads == (Load(0.5, (0.3, 0.1, 0.05)),)
    assert log.timeline.entries[1].plan.roles == {"L1": Carry("crate")}
    _, message = list(log.messages("/viz/loads"))[40]
    cubes = {e.id: e.cubes[0] for e in message.entities}
    measured, planned = cubes["crate"].pose.position, cubes["crate planned"].pose.position
    assert (measured.x, measured.y, measured.z) == (5.0, 6.0, 7.0)
    row = int(np.argmin(np.abs(times - 40 / 25)))
    x, y, z, *_, yaw = plan.base_poses[row]
    ahead = [x + 0.3 * np.cos(yaw) - 0.1 * np.sin(yaw), y + 0.3 * np.sin(yaw) + 0.1 * np.cos(yaw), z + 0.05]
    assert [planned.x, planned.y, planned.z] == pytest.approx(ahead, abs=1e-6)
    assert "crate" not in {e.id for _, update in log.messages("/viz/scene") for e in update.entities}
