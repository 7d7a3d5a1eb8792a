"""Limbs, feet and sides, recognised from a robot's geometry.

A limb is a chain that leaves the base and ends in a foot; its side is where it is, never its place in
a list; limbs are numbered from front to rear.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from gaitforge.errors import InputError, Problem
from gaitforge.robot.assembly import GivenFoot
from gaitforge.robot.limbs import Foot, Limb, Side
from gaitforge.robot.tree import Joint, RigidTree

_LETTER: dict[str, str] = {"left": "L", "right": "R", "middle": "M"}


@dataclass(frozen=True, eq=False)
class _Found:
    foot: Foot
    joints: tuple[Joint, ...]
    hip: np.ndarray
    """(3,) first joint at zero posture, base frame [m]"""
    tip: np.ndarray
    """(3,) centre of the foot sphere at zero posture, base frame [m]"""
    limb: str
    side: str


def recognize(
    tree: RigidTree, feet: Sequence[GivenFoot], file: str, tools: Mapping[str, tuple[str, ...]] | None = None
) -> tuple[Limb, ...]:
    """Limbs L1…Ln, R1…Rn, M1…Mn for the given feet; `tools` are tool names by limb.

    Raises InputError when a foot's link does not exist, is not carried by a joint, or when two feet
    share a joint.
    """
    found = [_found(tree, given, i, file) for i, given in enumerate(feet)]
    _check_apart(found, file)
    reach = max((abs(f.hip[1] + f.tip[1]) for f in found), default=0.0)
    limbs: list[Limb] = []
    for side in ("left", "right", "middle"):
        here = [f for f in found if _side(f, reach) == side]
        here.sort(key=lambda f: (-round(float(f.hip[0]), 3), -float(f.tip[0])))
        for number, f in enumerate(here, 1):
            name = f"{_LETTER[side]}{number}"
            if f.limb and f.limb != name:
                expected = f"{name}: limb {number} from the front on the {side} side"
                raise InputError(Problem(file, f"limbs: {f.limb}", f"{f.limb} at {_words(f.hip)}", expected))
            limbs.append(_limb(tree, name, side, f, (tools or {}).get(name, ())))
    return tuple(limbs)


def _words(point: np.ndarray) -> str:
    return f"x {point[0]:.3f} m, y {point[1]:.3f} m"


def _found(tree: RigidTree, given: GivenFoot, index: int, file: str) -> _Found:
    names = [x.name for x in tree.links]
    if given.foot.link not in names:
        raise InputError(Problem(file, f"feet[{index}].link", repr(given.foot.link), "one of " + ", ".join(names)))
    joints = tree.path(given.foot.link)
    if not joints:
        raise InputError(
            Problem(file, f"feet[{index}].link", f"{given.foot.link!r}, the base itself", "a link that joints carry")
        )
    T = tree.pose(given.foot.link)
    hip = joints[0].origin[:3, 3]
    return _Found(given.foot, joints, hip, T[:3, :3] @ given.foot.offset + T[:3, 3], given.limb, given.side)


def _check_apart(found: Sequence[_Found], file: str) -> None:
    owner: dict[str, str] = {}
    for f in found:
        for joint in f.joints:
            if joint.name in owner:
                what = f"the feet {owner[joint.name]} and {f.foot.link} both behind the joint {joint.name}"
                raise InputError(Problem(file, "feet", what, "limbs that meet in the base alone"))
            owner[joint.name] = f.foot.link


def _side(f: _Found, reach: float) -> Side:
    if f.side:
        return f.side  # type: ignore[return-value]
    y = float(f.hip[1] + f.tip[1])
    if abs(y) <= 0.05 * reach:
        return "middle"
    return "left" if y > 0.0 else "right"


def _limb(tree: RigidTree, name: str, side: Side, f: _Found, tools: tuple[str, ...]) -> Limb:
    links = tree.below(f.joints[0].child)
    walking = tuple(j.name for j in f.joints)
    others = tuple(j.name for x in links for j in tree.joints_from(x) if j.name not in walking)
    return Limb(name, side, walking, f.foot, links, tools, others)
