"""How a timeline is put to a robot, the same in every simulator: rows of a plan, a spawn, a servo law's target."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.timeline import Timeline, TimelineSamples
from gaitforge.robot.model import RobotModel
from gaitforge.verify.simulator import Progress

Array = NDArray[np.float64]
REPORTS = 100


def planned_rows(timeline: Timeline, rate_hz: float) -> TimelineSamples:
    """The plan at every step: row k is commanded in the step from times[k] to times[k + 1].

    A periodic spline is back at its start at the very end, so the last sample is taken just before it.
    """
    times = np.arange(int(np.floor(timeline.duration * rate_hz + 1e-6)) + 1) / rate_hz
    return replace(timeline.sample(np.minimum(times, timeline.duration - 1e-9)), times=times)


def planned_speeds(plan: TimelineSamples, rate_hz: float) -> Array:
    """(n, n_J) joint speed [rad/s] that leads from each row to the next; 0 in the last."""
    return np.asarray(np.diff(plan.joint_positions, axis=0, append=plan.joint_positions[-1:]) * rate_hz)


def spawn_pose(robot: RobotModel, plan: TimelineSamples) -> Array:
    """(6,) the first planned pose of base_link, moved up or down until the lowest stance foot touches the ground."""
    pose = plan.base_poses[0].copy()
    feet = robot.foot_positions(pose, plan.joint_positions[0])
    radii = np.array([limb.foot.radius for limb in robot.limbs])
    stance = plan.contact[0] if plan.contact[0].any() else np.ones(len(radii), dtype=bool)
    pose[2] -= float((feet[:, 2] - radii)[stance].min())
    return np.asarray(pose)


def tell(progress: Progress | None, done: int, rows: int) -> None:
    """Report `done` of `rows`, at most a hundred times in a run."""
    if progress is not None and done * REPORTS // rows > (done - 1) * REPORTS // rows:
        progress(done / rows)
