"""Feet found in a robot that does not say where they are: a URDF file.

There is no convention for feet in URDF, so this recognises, says what it recognised, and leaves the
last word to ``feet:`` in a YAML beside the file.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np

from gaitforge.robot.assembly import GivenFoot
from gaitforge.robot.capsules import bounds
from gaitforge.robot.limbs import Foot
from gaitforge.robot.posture import Chain, sampled
from gaitforge.robot.tree import Link, RigidTree

SAMPLES = 400
"""Postures tried to find out how low a chain can reach."""
NEAR_GROUND = 0.02
"""[m]"""


@dataclass(frozen=True, eq=False)
class FoundFeet:
    """What was recognised, and in words what was not."""

    feet: tuple[GivenFoot, ...]
    notes: tuple[str, ...]


def find_feet(tree: RigidTree) -> FoundFeet:
    """Feet of a merged tree: terminal links with contact geometry that reach the ground the others stand on."""
    notes: list[str] = []
    candidates: list[Foot] = []
    for link in tree.links:
        if tree.joints_from(link.name) or link.name == tree.root:
            continue
        foot = _sphere(link) or _tip(link, notes)
        if foot is not None:
            candidates.append(foot)
        elif any(s.collision for s in link.shapes):
            notes.append(f"link {link.name}: a terminal link without a sphere or a named tip, taken for no foot")
    kept = _grounded(tree, candidates, notes)
    return FoundFeet(tuple(GivenFoot(f) for f in kept), tuple(notes))


def _sphere(link: Link) -> Foot | None:
    """The collision sphere farthest from the link's joint."""
    spheres = [s for s in link.shapes if s.collision and s.kind == "sphere"]
    if not spheres:
        return None
    last = max(spheres, key=lambda s: float(np.linalg.norm(s.placement[:3, 3])))
    x, y, z = (float(v) for v in last.placement[:3, 3])
    return Foot(link.name, (x, y, z), float(last.size[0]))


def _tip(link: Link, notes: list[str]) -> Foot | None:
    """The end of a link without spheres: the farthest link merged into it, as thick as what it carries there."""
    frames = [f for f in link.frames if f.name != link.name and np.linalg.norm(f.T[:3, 3]) > 0.02]
    solid = [s for s in link.shapes if s.collision]
    if not frames or not solid:
        return None
    end = max(frames, key=lambda f: float(np.linalg.norm(f.T[:3, 3])))
    point = end.T[:3, 3]
    along = point / np.linalg.norm(point)
    beyond = max(float((bounds(s) @ along).max()) for s in solid) - float(np.linalg.norm(point))
    radius = min(max(beyond, 0.005), 0.06)
    notes.append(f"link {link.name}: no collision sphere; its foot is taken at {end.name}, radius {radius:.3f} m")
    x, y, z = (float(v) for v in point)
    return Foot(link.name, (x, y, z), radius)


def _grounded(tree: RigidTree, feet: list[Foot], notes: list[str]) -> list[Foot]:
    """Without heads, tails and arms: what never reaches the ground, or hangs high on a chain unlike the others."""
    if len(feet) < 4:
        return feet
    chains = [Chain.of(tree, f) for f in feet]
    heights = [float(c.tip(c.rest)[2]) - f.radius for c, f in zip(chains, feet, strict=True)]
    ground = sorted(heights)[2]
    usual = Counter(len(c.joints) for c in chains).most_common(1)[0][0]
    kept = []
    for foot, chain, height in zip(feet, chains, heights, strict=True):
        if height > ground + NEAR_GROUND:
            lowest = float(chain.tip(sampled(chain, SAMPLES))[:, 2].min()) - foot.radius
            if lowest > ground + NEAR_GROUND:
                notes.append(f"link {foot.link}: never reaches the ground of the others, taken for no foot")
                continue
            if len(chain.joints) != usual:
                notes.append(f"link {foot.link}: high up on a chain of {len(chain.joints)} joints, taken for no foot")
                continue
        kept.append(foot)
    return kept
