"""Where a load comes down on what it is put on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gaitforge.motion.manipulation.holding import Holding
from gaitforge.motion.manipulation.putting import inside_top
from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.timeline import Entry
from gaitforge.task.scene import SceneObject


@pytest.mark.parametrize(
    ("x", "y", "yaw", "expected"),
    [
        (1.0, 0.0, 0.0, 0.05),  # in the middle of a board of 0.4 × 0.1 m: half its width
        (1.15, 0.0, 0.0, 0.05),
        (1.17, 0.0, 0.0, 0.03),
        (1.25, 0.0, 0.0, -0.05),
        (1.0, 0.04, 0.0, 0.01),
        (1.15, 0.0, np.pi / 2, -0.1),  # the board lies across
    ],
)
def test_a_load_is_inside_the_edges_of_a_board_by_the_least_of_all_distances(
    tripod: MotionPlan, x: float, y: float, yaw: float, expected: float
) -> None:
    """The base stands at x = 0.5 m in the world and looks along y, the load 0.2 m before it and beside its middle."""
    base = np.tile([0.1, 0.2, 0.15, 0.0, 0.0, 0.0], (len(tripod.times), 1))
    aside = 0.5 - x  # [m] to the left of a robot that looks along y
    holding = Holding("tray", np.array([[y + 0.2, aside, 0.3, 0.0, 0.0, 0.0]]))
    plan = replace(tripod, base_poses=base, holdings=(holding,))
    origin = np.array([0.5 + 0.2, -0.2 - 0.1, np.pi / 2])  # the base of the plan, turned, comes to be at (0.5, −0.2)
    board = SceneObject("board", "box", (1.0, 0.0, 0.4), (0.0, 0.0, yaw), size=(0.4, 0.1, 0.02))
    assert inside_top(Entry(plan, 1, 0.0, origin), "tray", board) == pytest.approx(expected, abs=1e-12)
