"""The ``nominal:`` block of a robot: standing and held postures, and the defaults of its gaits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from gaitforge.robot.limbs import Limb
from gaitforge.robot.model import Nominal
from gaitforge.robot.posture import held as default_held
from gaitforge.robot.posture import standing as default_standing
from gaitforge.robot.read import Section
from gaitforge.robot.tree import RigidTree

GAITS = ("tripod", "wave", "program")
_SIDES = ("left", "right", "middle")
_KEYS = (
    "posture", "held_posture", "speed", "duration", "columns", "step_height", "gait", "transition_columns",
    "transition_column_s", "postures",
)  # fmt: skip
UNEVEN = 0.02
"""[m] a standing posture whose feet differ more in height is refused."""


def read_nominal(s: Section, tree: RigidTree, limbs: Sequence[Limb], joint_names: Sequence[str]) -> Nominal:
    """The block checked against the robot; notes problems in the section."""
    s.only(*_KEYS)
    standing, ground = _standing(s, tree, limbs)
    held = _held(s, tree, limbs, standing)
    return Nominal(
        posture=np.array([standing[n] for n in joint_names]),
        held_posture=np.array([held[n] for n in joint_names]),
        body_height=-ground,
        speed=s.number("speed", "m/s", 0.064, above=0.0),
        duration=s.number("duration", "s", 2.0, above=0.0),
        columns=s.integer("columns", 12, 2),
        step_height=s.number("step_height", "m", 0.03, above=0.0),
        gait=s.text("gait", GAITS, "wave" if len(limbs) <= 4 else "tripod"),
        transition_columns=s.integer("transition_columns", 11, 2),
        transition_column_s=s.number("transition_column_s", "s", 0.125, above=0.0),
        postures=_postures(s, tree, limbs, joint_names, standing),
    )


def _standing(s: Section, tree: RigidTree, limbs: Sequence[Limb]) -> tuple[dict[str, float], float]:
    """Joint → angle [rad], and the height of the ground in the base frame [m]."""
    rest = {j.name: float(np.clip(0.0, j.lower, j.upper)) for j in tree.joints}
    if "posture" not in s:
        rest |= default_standing(tree, limbs)
    angles = _posture(s, "posture", limbs, tree, rest)
    heights = foot_bottoms(tree, limbs, angles)
    ground = min(heights.values())
    if "posture" in s and max(heights.values()) - ground > UNEVEN:
        found = ", ".join(f"{n} {1e3 * (h - ground):.0f} mm" for n, h in heights.items())
        s.problem("posture", f"feet at heights {found}", f"all feet on the ground, within {1e3 * UNEVEN:.0f} mm")
    return angles, ground


def _postures(
    s: Section, tree: RigidTree, limbs: Sequence[Limb], joint_names: Sequence[str], standing: Mapping[str, float]
) -> dict[str, NDArray[np.float64]]:
    """Further standing postures by name, (n_J,) [rad]; what one does not speak of stands as it does nominally."""
    block = s.child("postures")
    found = {}
    for name in block.data:
        if name == "nominal":
            block.problem(name, "the posture 'nominal'", "another name: it is the one of posture:")
        angles = _posture(block, name, limbs, tree, standing)
        found[str(name)] = np.array([angles[n] for n in joint_names])
    return found


def _held(s: Section, tree: RigidTree, limbs: Sequence[Limb], standing: dict[str, float]) -> dict[str, float]:
    """Joint → angle [rad]; a limb that the block does not speak of gets a raised posture of its own."""
    given = s.child("held_posture")
    others = [x for x in limbs if x.name not in given and x.side not in given]
    return _posture(s, "held_posture", limbs, tree, default_held(tree, others, standing) if others else standing)


def foot_bottoms(tree: RigidTree, limbs: Sequence[Limb], angles: Mapping[str, float]) -> dict[str, float]:
    """Limb → height of the lowest point of its foot sphere in the base frame [m]."""
    out = {}
    for limb in limbs:
        T = tree.pose(limb.foot.link, dict(angles))
        out[limb.name] = float((T[:3, :3] @ limb.foot.offset + T[:3, 3])[2]) - limb.foot.radius
    return out


def _posture(
    s: Section, key: str, limbs: Sequence[Limb], tree: RigidTree, rest: Mapping[str, float]
) -> dict[str, float]:
    """Joint → angle [rad]: `rest`, overruled by the limb's side, overruled by the limb itself."""
    angles, joints = dict(rest), {j.name: j for j in tree.joints}
    block = s.child(key)
    names = [x.name for x in limbs]
    for name in block.data:
        if name not in names and name not in _SIDES:
            block.problem(name, f"the limb {name!r}", "left, right, middle or one of " + ", ".join(names))
    for limb in limbs:
        entry = limb.name if limb.name in block else limb.side
        if entry not in block:
            continue
        raw = block.data[entry]
        chain = limb.joints if not _long(raw, limb) else limb.joints + limb.tool_joints
        values = block.vector(entry, len(chain), "rad")
        for joint, value in zip(chain, values, strict=True):
            angles[joint] = value
            lower, upper = joints[joint].lower, joints[joint].upper
            if not lower - 1e-9 <= value <= upper + 1e-9:
                block.problem(entry, f"{value:g} for {joint}", f"between {lower:g} and {upper:g} [rad]")
    return angles


def _long(raw: object, limb: Limb) -> bool:
    """Does a posture speak of the limb's tool joints too?"""
    return isinstance(raw, list) and len(raw) == len(limb.joints) + len(limb.tool_joints)
