"""A timeline out of the arrays of ``plan.npz``, ready to be executed again."""

from __future__ import annotations

from typing import Any

import numpy as np

from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.report import SolveReport
from gaitforge.motion.timeline import Entry, Timeline
from gaitforge.record.archive import Arrays, text
from gaitforge.record.values import from_plain
from gaitforge.robot.model import RobotModel


def timeline_from_arrays(robot: RobotModel, arrays: Arrays) -> Timeline:
    """The timeline that `plan_archive` was given: equal arrays, equal splines.

    Raises
    ------
    KeyError
        When an array is missing.
    """
    names = [str(name) for name in arrays["timeline/segment"]]
    plans = {name: _plan(name, arrays) for name in dict.fromkeys(names)}
    columns = (arrays["timeline/cycles"], arrays["timeline/start"], arrays["timeline/origin"])
    entries = tuple(
        Entry(plans[name], int(cycles), float(start), np.array(origin))
        for name, cycles, start, origin in zip(names, *columns, strict=True)
    )
    return Timeline(robot, entries, from_plain(text(arrays, "timeline/aims")), _overrides(arrays))


def _plan(name: str, arrays: Arrays) -> MotionPlan:
    info = text(arrays, f"{name}/info")
    report: dict[str, Any] = {key: np.nan if value is None else value for key, value in info["report"].items()}
    pattern = FootfallPattern(
        arrays[f"{name}/C"], tuple(info["limbs"]), info["cyclic"], info["source"], tuple(info["pattern_relaxed"])
    )
    return MotionPlan(
        name=info["name"],
        kind=info["kind"],
        pattern=pattern,
        times=arrays[f"{name}/times"],
        joint_positions=arrays[f"{name}/P"],
        base_poses=arrays[f"{name}/base"],
        com=arrays[f"{name}/com"],
        feet=arrays[f"{name}/feet"],
        weights=arrays[f"{name}/weights"],
        command=from_plain(info["command"]),
        roles=from_plain(info["roles"]),
        loads=from_plain(info.get("loads", [])),
        stance=from_plain(info.get("stance")),
        holdings=from_plain(info.get("holdings", [])),
        joint_velocity_ends=arrays.get(f"{name}/joint_velocity_ends"),
        base_velocity_ends=arrays.get(f"{name}/base_velocity_ends"),
        report=SolveReport(**report),
        relaxed=tuple(info["relaxed"]),
    )


def _overrides(arrays: Arrays) -> tuple[Any, ...]:
    from scipy.interpolate import PPoly

    found: list[tuple[int, PPoly, float, float]] = []
    while f"override/{len(found)}/row" in arrays:
        key = f"override/{len(found)}"
        start, end = (float(v) for v in arrays[f"{key}/window"])
        found.append((int(arrays[f"{key}/row"]), PPoly(arrays[f"{key}/c"], arrays[f"{key}/x"]), start, end))
    return tuple(found)
