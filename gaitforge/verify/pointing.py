"""How far a camera's optical axis is from the direction to its target."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitforge.motion.timeline import Timeline

Array = NDArray[np.float64]


def pointing_angle(T_world_tool: Array, target: ArrayLike) -> Array:
    """(n,) angle [rad] between the z axis of each pose (n, 4, 4) and the direction to `target` (3,) [m]."""
    sight = np.asarray(target, dtype=float) - T_world_tool[:, :3, 3]
    axis = T_world_tool[:, :3, 2]
    return np.asarray(np.arctan2(np.linalg.norm(np.cross(axis, sight), axis=1), (axis * sight).sum(axis=1)))


def pointing(timeline: Timeline, times: Array, tools: dict[str, Array]) -> dict[str, Array]:
    """tool name → (n,) angle to the target of the aim that holds then [rad], NaN while there is none."""
    angles: dict[str, Array] = {}
    for aim in timeline.aims:
        angle = angles.setdefault(aim.tool, np.full(len(times), np.nan))
        rows = aim_rows(times, aim.start, aim.end)
        angle[rows] = pointing_angle(tools[aim.tool][rows], aim.target)
    return angles


def aim_rows(times: Array, start: float, end: float) -> NDArray[np.bool_]:
    """(n,) rows within [start, end] [s], rounding forgiven."""
    return np.asarray((times >= start - 1e-9) & (times <= end + 1e-9))
