"""What is wrong with robot files in the wild: things that load, and then fall over quietly.

Each rule names a failure that was seen: a link without mass weighs 1 kg in PyBullet, an inertia that
is not physical becomes zero there, a joint without effort cannot move.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from gaitforge.errors import InputError, Problem
from gaitforge.robot.capsules import bounds
from gaitforge.robot.geometry import inertia_defect
from gaitforge.robot.tree import Joint, Link, RigidTree
from gaitforge.robot.urdf import MAX_LINKS


@dataclass(frozen=True)
class Finding:
    """One thing that is wrong."""

    key: str
    """``link <name>`` or ``joint <name>``"""
    found: str
    expected: str
    fatal: bool

    def __str__(self) -> str:
        return f"{self.key}: found {self.found}; expected {self.expected}"


def refuse(findings: Iterable[Finding], file: str) -> None:
    """InputError with every fatal finding, if there is one."""
    fatal = [Problem(file, f.key, f.found, f.expected) for f in findings if f.fatal]
    if fatal:
        raise InputError(fatal)


def lint_structure(tree: RigidTree) -> tuple[Finding, ...]:
    """Names and connections of a tree as it was read; nothing else can be looked at before these hold."""
    return tuple(_names(tree)) + tuple(_connections(tree))


def lint(tree: RigidTree) -> tuple[Finding, ...]:
    """Masses, inertias, limits and size of a tree whose structure is sound and whose fixed joints are merged."""
    findings = [f for link in tree.links for f in _link(tree, link)]
    findings += [f for joint in tree.joints for f in _joint(joint)]
    if len(tree.joints) > MAX_LINKS:
        expected = f"at most {MAX_LINKS} for PyBullet; MuJoCo verifies the robot"
        findings.append(Finding("robot", f"{len(tree.joints)} joints", expected, False))
    return tuple(findings)


def _names(tree: RigidTree) -> Iterator[Finding]:
    links, joints = Counter(x.name for x in tree.links), Counter(j.name for j in tree.joints)
    for kind, names in (("link", links), ("joint", joints)):
        for name, times in names.items():
            if times > 1:
                yield Finding(f"{kind} {name}", f"{times} {kind}s of that name", "unique names", True)
    for name in sorted(set(links) & set(joints)):
        yield Finding(f"joint {name}", "a link of the same name", "different names for links and joints", False)


def _connections(tree: RigidTree) -> Iterator[Finding]:
    links = {x.name for x in tree.links}
    children = Counter(j.child for j in tree.joints)
    for joint in tree.joints:
        for end in (joint.parent, joint.child):
            if end not in links:
                yield Finding(f"joint {joint.name}", f"the link {end!r}", "a link of the file", True)
    for name, times in children.items():
        if times > 1:
            yield Finding(f"link {name}", f"{times} parents", "one parent", True)
    roots = [x for x in links if x not in children]
    if len(roots) != 1:
        yield Finding("robot", f"{len(roots)} links without a parent", "exactly one, the base", True)
    elif len(set(tree.below(tree.root))) != len(links):
        yield Finding("robot", "links that do not hang on the base", "one connected tree", True)


def _link(tree: RigidTree, link: Link) -> Iterator[Finding]:
    key, inertia = f"link {link.name}", link.inertia
    if inertia.mass <= 0.0:
        yield Finding(key, f"a mass of {inertia.mass:g} kg", "an inertial with a mass > 0", True)
        return
    defect = inertia_defect(inertia.matrix)
    if defect is not None:
        yield Finding(key, defect, "a physical inertia", "definite" in defect or "symmetric" in defect)
        return
    solids = [s for s in link.shapes if s.collision and s.kind != "mesh"]
    if solids:
        corners = np.concatenate([bounds(s) for s in solids])
        reach = np.linalg.norm(np.maximum(np.abs(corners.min(0) - inertia.com), np.abs(corners.max(0) - inertia.com)))
        gyration = float(np.sqrt(np.trace(inertia.matrix) / 2.0 / inertia.mass))
        if gyration > reach:
            found = f"a gyration radius of {gyration:.3g} m"
            yield Finding(key, found, f"less than the reach of its collision shapes, {reach:.3g} m", False)


def _joint(joint: Joint) -> Iterator[Finding]:
    key = f"joint {joint.name}"
    if joint.type != "revolute":
        yield Finding(key, f"type {joint.type}", "revolute, continuous or fixed", True)
        return
    if np.linalg.norm(joint.axis) < 0.5:
        yield Finding(key, "an axis of length 0", "a direction", True)
    if joint.lower >= joint.upper:
        yield Finding(key, f"lower {joint.lower:g}, upper {joint.upper:g} rad", "lower < upper", True)
    if joint.effort <= 0.0:
        yield Finding(key, f"effort {joint.effort:g} N m", "> 0", True)
    if joint.velocity <= 0.0:
        yield Finding(key, f"velocity {joint.velocity:g} rad/s", "> 0", True)
