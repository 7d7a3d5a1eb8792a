"""A robot as a tree of rigid links: what assemblies are built into, and what URDF files are read into."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from gaitforge.robot.geometry import Array, Inertia, Shape, merged, turn


@dataclass(frozen=True, eq=False)
class Frame:
    """A named place on a link."""

    name: str
    T: Array
    """(4, 4) in the link frame"""


@dataclass(frozen=True, eq=False)
class Link:
    """One rigid body."""

    name: str
    inertia: Inertia = field(default_factory=Inertia)
    shapes: tuple[Shape, ...] = ()
    frames: tuple[Frame, ...] = ()
    """What was rigidly part of it: the links merged into it."""


@dataclass(frozen=True, eq=False)
class Joint:
    """What connects two links; angle 0 puts the child's frame at `origin`."""

    name: str
    type: str
    """revolute · continuous · prismatic · fixed · floating · planar"""
    parent: str
    child: str
    origin: Array = field(default_factory=lambda: np.eye(4))
    """(4, 4) of the joint (and child) frame in the parent's"""
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    """In the joint frame."""
    lower: float = 0.0
    """[rad]"""
    upper: float = 0.0
    effort: float = 0.0
    """[N m]"""
    velocity: float = 0.0
    """[rad/s]"""
    damping: float = 0.0
    """[N m s/rad]"""
    friction: float = 0.0
    """[N m]"""


@dataclass(frozen=True, eq=False)
class RigidTree:
    """Links and the joints between them, in the order they are written."""

    name: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]

    def link(self, name: str) -> Link:
        """The link of that name; KeyError when there is none."""
        for link in self.links:
            if link.name == name:
                return link
        raise KeyError(name)

    @property
    def root(self) -> str:
        """Name of the link that no joint carries."""
        children = {j.child for j in self.joints}
        return next(x.name for x in self.links if x.name not in children)

    @property
    def mass(self) -> float:
        """[kg]"""
        return float(sum(x.inertia.mass for x in self.links))

    def joints_from(self, link: str) -> tuple[Joint, ...]:
        """Joints whose parent is the link."""
        return tuple(j for j in self.joints if j.parent == link)

    def path(self, link: str) -> tuple[Joint, ...]:
        """Joints from the root to the link."""
        above = {j.child: j for j in self.joints}
        chain: list[Joint] = []
        while link in above:
            chain.append(above[link])
            link = above[link].parent
        return tuple(reversed(chain))

    def below(self, link: str) -> tuple[str, ...]:
        """The link and every link that it carries, depth first."""
        names = [link]
        for joint in self.joints_from(link):
            names.extend(self.below(joint.child))
        return tuple(names)

    def pose(self, link: str, angles: dict[str, float] | None = None) -> Array:
        """(4, 4) pose of a link in the root's frame; joints not in `angles` [rad] are at zero."""
        T = np.eye(4)
        for joint in self.path(link):
            T = T @ joint.origin @ turn(joint.axis, (angles or {}).get(joint.name, 0.0))
        return T


def rigid_groups(tree: RigidTree) -> RigidTree:
    """The same robot with one link per rigid group: children of fixed joints merged into their parents."""
    home: dict[str, tuple[str, Array]] = {}
    for name in tree.below(tree.root):
        above = next((j for j in tree.joints if j.child == name), None)
        if above is None or above.type != "fixed":
            home[name] = (name, np.eye(4))
        else:
            group, T = home[above.parent]
            home[name] = (group, T @ above.origin)
    groups = [n for n in home if home[n][0] == n]
    links = [_group(tree, g, [(n, T) for n, (owner, T) in home.items() if owner == g]) for g in groups]
    movable = [j for j in tree.joints if j.type != "fixed"]
    joints = [replace(j, parent=home[j.parent][0], origin=home[j.parent][1] @ j.origin) for j in movable]
    return RigidTree(tree.name, tuple(links), tuple(joints))


def _group(tree: RigidTree, name: str, members: Sequence[tuple[str, NDArray[np.float64]]]) -> Link:
    parts = [(tree.link(n), T) for n, T in members]
    inertia = merged([link.inertia.moved(T) for link, T in parts])
    shapes = tuple(s.moved(T) for link, T in parts for s in link.shapes)
    frames = [f for link, T in parts for f in (Frame(link.name, T), *(Frame(x.name, T @ x.T) for x in link.frames))]
    return Link(name, inertia, shapes, tuple(frames))
