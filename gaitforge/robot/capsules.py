"""Capsules around collision shapes, for clearance between limbs."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from gaitforge.robot.geometry import Array, Shape
from gaitforge.robot.limbs import Limb
from gaitforge.robot.model import Capsule
from gaitforge.robot.tree import RigidTree


def limb_capsules(tree: RigidTree, limbs: Iterable[Limb]) -> tuple[Capsule, ...]:
    """One capsule per collision shape of the limbs' links (the base's own shapes are not among them)."""
    links = [name for limb in limbs for name in limb.links]
    return tuple(capsule(name, s) for name in links for s in tree.link(name).shapes if s.collision)


def capsule(link: str, shape: Shape) -> Capsule:
    """The capsule along a shape's longest axis that encloses the shape."""
    T, size, centre = shape.placement, np.asarray(shape.size), np.zeros(3)
    if shape.kind == "mesh":
        size, centre = _mesh_box(shape)
    axis, half, radius = np.zeros(3), 0.0, float(size[0])
    if shape.kind == "cylinder":
        axis, half = np.array([0.0, 0.0, 1.0]), float(size[1]) / 2.0
    elif shape.kind != "sphere":
        longest = int(np.argmax(size))
        axis, half = np.eye(3)[longest], float(size[longest]) / 2.0
        radius = float(np.linalg.norm(np.delete(size, longest))) / 2.0
    a, b = (T[:3, :3] @ (centre + sign * half * axis) + T[:3, 3] for sign in (-1.0, 1.0))
    return Capsule(link, _point(a), _point(b), radius)


def _point(p: Array) -> tuple[float, float, float]:
    x, y, z = (float(round(v, 12)) for v in p)
    return x, y, z


def _mesh_box(shape: Shape) -> tuple[Array, Array]:
    """Edge lengths and centre of a mesh's bounding box [m]."""
    import trimesh

    lower, upper = trimesh.load(shape.file, force="mesh").bounds * np.asarray(shape.size)
    return np.abs(upper - lower), (upper + lower) / 2.0
