"""Capsules and boxes around collision shapes, for clearance between limbs and to the trunk."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np

from gaitforge.robot.geometry import Array, Shape
from gaitforge.robot.limbs import Limb
from gaitforge.robot.model import Box, Capsule
from gaitforge.robot.tree import RigidTree


def limb_capsules(tree: RigidTree, limbs: Iterable[Limb]) -> tuple[Capsule, ...]:
    """One capsule per collision shape of the limbs' links (the base's own shapes are not among them)."""
    links = [name for limb in limbs for name in limb.links]
    return tuple(capsule(name, s) for name in links for s in tree.link(name).shapes if s.collision)


def trunk_boxes(tree: RigidTree) -> tuple[Box, ...]:
    """One box per collision shape of the root link."""
    return tuple(enclosing_box(s) for s in tree.link(tree.root).shapes if s.collision)


def enclosing_box(shape: Shape) -> Box:
    """The box along a shape's own axes that encloses it."""
    size, centre = own_box(shape)
    T = shape.placement
    rows = tuple(_point(row) for row in T[:3, :3])
    return Box(_point(T[:3, :3] @ centre + T[:3, 3]), rows, _point(size))


def capsule(link: str, shape: Shape) -> Capsule:
    """The capsule along a shape's longest axis that encloses the shape."""
    T, size, centre = shape.placement, np.asarray(shape.size), np.zeros(3)
    if shape.kind == "mesh":
        size, centre = mesh_box(shape)
    axis, half, radius = np.zeros(3), 0.0, float(size[0])
    if shape.kind == "cylinder":
        axis, half = np.array([0.0, 0.0, 1.0]), float(size[1]) / 2.0
    elif shape.kind != "sphere":
        longest = int(np.argmax(size))
        axis, half = np.eye(3)[longest], float(size[longest]) / 2.0
        radius = float(np.linalg.norm(np.delete(size, longest))) / 2.0
    a, b = (T[:3, :3] @ (centre + sign * half * axis) + T[:3, 3] for sign in (-1.0, 1.0))
    return Capsule(link, _point(a), _point(b), radius)


def bounds(shape: Shape) -> Array:
    """(8, 3) corners of a box, in the link frame, that encloses the shape [m]."""
    size, centre = own_box(shape)
    corners = centre + np.array(list(product((-0.5, 0.5), repeat=3))) * size
    return np.asarray(corners @ shape.placement[:3, :3].T + shape.placement[:3, 3])


def own_box(shape: Shape) -> tuple[Array, Array]:
    """(3,) edge lengths and (3,) centre, in the shape's own frame, of the box that encloses it [m]."""
    if shape.kind == "mesh":
        return mesh_box(shape)
    if shape.kind == "box":
        return np.asarray(shape.size), np.zeros(3)
    if shape.kind == "cylinder":
        return np.array([2.0 * shape.size[0], 2.0 * shape.size[0], shape.size[1]]), np.zeros(3)
    return np.full(3, 2.0 * shape.size[0]), np.zeros(3)


def _point(p: Array) -> tuple[float, float, float]:
    x, y, z = (float(round(v, 12)) for v in p)
    return x, y, z


def mesh_box(shape: Shape) -> tuple[Array, Array]:
    """Edge lengths and centre of a mesh's bounding box [m]."""
    corners = mesh_vertices(shape.file) * np.asarray(shape.size)
    lower, upper = corners.min(axis=0), corners.max(axis=0)
    return upper - lower, (upper + lower) / 2.0


@lru_cache(maxsize=64)
def mesh_vertices(file: str) -> Array:
    """(n, 3) vertices of a mesh file, unscaled [m]."""
    import trimesh

    mesh: Any = trimesh.load(file, force="mesh")
    return np.array(mesh.vertices, dtype=np.float64)
