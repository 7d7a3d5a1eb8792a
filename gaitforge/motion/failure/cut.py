"""The first columns of a gait's cycle as a segment of their own: what is walked until something happens."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.report import SolveReport


def begun(gait: MotionPlan, columns: int, name: str) -> MotionPlan:
    """The gait from its seam to the end of its first `columns` columns; ValueError unless 0 < columns < m.

    The clamped spline through the same samples with the same velocities at both ends is the gait's own; what it took
    to find it stands in the gait's report alone.
    """
    if gait.kind != "gait" or not 0 < columns < gait.pattern.columns:
        raise ValueError(f"{columns} columns of {gait.kind} {gait.name} with {gait.pattern.columns}")
    last = columns * gait.samples_per_column
    ends = gait.times[[0, last]]
    contact = gait.pattern.contact[:, :columns]
    return replace(
        gait,
        name=name,
        kind="transition",
        report=SolveReport(gait.report.status, details={"part_of": gait.name}),
        pattern=replace(gait.pattern, contact=contact, cyclic=False),
        times=gait.times[: last + 1],
        joint_positions=gait.joint_positions[:, : last + 1],
        base_poses=gait.base_poses[: last + 1],
        com=gait.com[: last + 1],
        feet=gait.feet[: last + 1],
        weights=gait.weights[: last + 1],
        joint_velocity_ends=np.asarray(gait.joint_spline(ends, 1)),
        base_velocity_ends=np.asarray(gait.base_spline(ends, 1)),
    )
