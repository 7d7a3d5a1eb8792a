"""The list of commands is long enough, and what it measures is a velocity."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.commands_cases import ROBOTS, Case, Row, cases, row_of, velocity_errors
from benchmarks.commands_page import _lines
from gaitforge.motion.plan import Command
from gaitforge.motion.trajectory import planar_motion

VALUES = dict.fromkeys(
    ("speed_ratio", "effort_planned", "effort_measured", "zmp_margin_mm", "slip_mm", "tilt_deg", "height_m", "lift_mm",
     "slip_converged_mm", "velocity_converged_mm_s", "yaw_converged_deg_s"), 0.5,
)  # fmt: skip


@pytest.mark.parametrize("robot", ROBOTS)
def test_the_list_has_pairs_turns_heights_and_steps_enough(robot: str) -> None:
    listed = list(cases(robot, 0.133))
    assert len({case.key for case in listed}) == len(listed)
    pairs = {(c.heading_deg, c.speed) for c in listed if c.group == "velocity"}
    assert len(pairs) >= 24
    turns = [c for c in listed if c.yaw_deg_s]
    assert sorted((c.yaw_deg_s > 0, c.speed > 0) for c in turns) == [
        (a, b) for a in (False, True) for b in (False, True)
    ]
    assert len({c.body_height for c in listed if c.body_height is not None}) == 3
    assert len({c.step_height for c in listed if c.step_height is not None}) == 3


def walked(command: Command, cycles: int = 3, seconds: float = 2.0) -> tuple[SimpleNamespace, SimpleNamespace]:
    """A plan and a verdict of a body that drives exactly as commanded, one row each tenth of a second."""
    times = np.linspace(0.0, cycles * seconds, int(10 * cycles * seconds) + 1)
    poses = np.zeros((len(times), 6))
    poses[:, [0, 1, 5]] = [planar_motion(command, t) for t in times]
    plan = SimpleNamespace(kind="gait", command=command, duration=seconds, base_poses=poses[:1])
    timeline = SimpleNamespace(entries=[SimpleNamespace(plan=plan, cycles=cycles, start=0.0)])
    return plan, SimpleNamespace(trace=SimpleNamespace(times=times, base_poses=poses), timeline=timeline)


@pytest.mark.parametrize("asked", [Command(0.06, 0.7, 0.0), Command(0.05, 0.3, 0.2), Command(0.0, 0.0, -0.3)])
def test_a_body_that_drives_as_commanded_has_no_error(asked: Command) -> None:
    plan, verdict = walked(asked)
    percent, millimetres, yaw = velocity_errors(Case("x", "velocity", asked.speed), plan, verdict)
    assert percent is None if not asked.speed else percent == pytest.approx(0.0, abs=1e-9)
    assert (millimetres, yaw) == (pytest.approx(0.0, abs=1e-9), pytest.approx(0.0, abs=1e-9))


def test_errors_are_those_of_the_velocity_vector_and_of_the_yaw_rate() -> None:
    asked, done = Command(0.06), Command(0.057, 0.0, np.radians(1.5))
    _, verdict = walked(done)
    plan, _ = walked(asked)
    percent, millimetres, yaw = velocity_errors(Case("x", "velocity", 0.06), plan, verdict)
    off = np.linalg.norm(planar_motion(done, 2.0)[:2] - planar_motion(asked, 2.0)[:2]) / 2.0
    assert millimetres == pytest.approx(1e3 * off, rel=1e-9)
    assert percent == pytest.approx(100 * off / 0.06, rel=1e-9)
    assert yaw == pytest.approx(1.5, rel=1e-9)
    assert percent > 5.0


def test_rows_come_back_from_their_file_and_stand_on_the_page() -> None:
    case = next(cases("hexapod", 0.133))
    row = Row(case, "walks", "", (), 0.2, 0.4, 0.1, 0.05, ("slip",), VALUES)
    turning = replace(row, case=Case("hexapod", "on the spot", 0.0, 0.0, 8.0), velocity_percent=None)
    refused = Row(replace(case, speed=2.0), "refused", "2 m/s is impossible", ("joint_speed",))
    assert row_of(row.as_dict()) == row
    page = "\n".join(_lines([row, turning, refused], ["hexapod"]))
    assert "| hexapod | 3 | 2 | 2 | 0.4 |" in page
    assert "2 m/s is impossible" in page
