"""Where a load comes down on what it is put on."""

from __future__ import annotations

import numpy as np

from gaitforge.motion.timeline import Entry, place
from gaitforge.robot.rotation import matrices
from gaitforge.task.scene import SceneObject


def inside_top(entry: Entry, name: str, stand: SceneObject) -> float:
    """[m] by which the centre of the load `name` is inside the edges of the top of `stand`; < 0 when it is beyond.

    At the beginning of the entry, by plan; the box `stand` stands level.
    """
    holding = next(h for h in entry.plan.holdings if h.object == name)
    base = place(entry.plan.base_poses[:1], entry.origin)[0]
    centre = base[:3] + matrices(base[3:]) @ holding.poses[0, :3]
    local = matrices(np.array(stand.rpy)).T @ (centre - np.array(stand.xyz))
    return float((0.5 * np.array(stand.size[:2]) - np.abs(local[:2])).min())
