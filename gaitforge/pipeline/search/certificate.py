"""Speeds that no footfall pattern at all can walk at, told without a search."""

from __future__ import annotations

from collections.abc import Sequence

from gaitforge.errors import InfeasibleMotion
from gaitforge.robot.model import RobotModel

FEET_ON_GROUND = 3
"""g8"""


def refuse_impossible_speed(robot: RobotModel, locomotive: Sequence[str], speed: float, duration: float) -> None:
    """Raise `InfeasibleMotion` when `speed` [m/s] is out of reach for every pattern of cycle `duration` [s].

    Three feet stand at any time (g8), so of n limbs one stands for at least the share d = 3/n of the
    cycle, in one go (g1).  While it stands the body travels v·d·T, which no foot can follow farther than
    it reaches; and what it fell behind it makes up in the rest, v·d/(1 − d) fast.  The bounds take the
    best limb, so they hold whichever it is.
    """
    from gaitforge.motion.limits import fastest_foot, longest_reach

    limbs = [robot.limb(name) for name in locomotive]
    if len(limbs) <= FEET_ON_GROUND:
        return
    share = FEET_ON_GROUND / len(limbs)
    reach = max(longest_reach(robot, limb) for limb in limbs)
    fastest = max(fastest_foot(robot, limb) for limb in limbs)
    by_reach, by_joints = reach / (share * duration), fastest / max(1.0, share / (1.0 - share))
    limit = min(by_reach, by_joints)
    if speed <= limit:
        return
    joints = by_joints <= by_reach
    reason = (
        f"no joint can follow: a foot moves at most {fastest:.2f} m/s"
        if joints
        else f"a foot would have to stay on the ground for {speed * share * duration:.2f} m and reaches {reach:.2f} m"
    )
    raise InfeasibleMotion(
        f"{speed:g} m/s is impossible for {robot.name} with any footfall pattern of {duration:g} s: {reason}",
        {
            "families": ["joint_speed" if joints else "reach"],
            "limbs": list(locomotive),
            "advice": f"walk slower than {limit:.2f} m/s, or with a shorter cycle",
        },
    )
