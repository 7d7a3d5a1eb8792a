"""URDF files written by others, read into a tree of links."""

from __future__ import annotations

import logging
import math
from pathlib import Path
from typing import Any

import numpy as np

from gaitforge.errors import InputError, Problem
from gaitforge.robot.geometry import Inertia, Shape
from gaitforge.robot.tree import Joint, Link, RigidTree


def read_urdf(path: Path) -> tuple[RigidTree, tuple[str, ...]]:
    """The links and joints of a URDF file as they stand there, and warnings about meshes that are left out.

    Raises InputError when the file is no URDF.
    """
    import yourdfpy

    logging.getLogger("yourdfpy").setLevel(logging.ERROR)
    try:
        urdf = yourdfpy.URDF.load(str(path), build_scene_graph=False, load_meshes=False)
        robot = urdf.robot
    except Exception as error:  # yourdfpy and lxml raise many kinds for a file that is no URDF
        raise InputError(Problem(str(path), "", f"{type(error).__name__}: {error}", "a URDF file")) from error
    warnings: list[str] = []
    colors = {m.name: m.color for m in robot.materials if m.color is not None}
    links = tuple(_link(x, path, colors, warnings) for x in robot.links)
    return RigidTree(robot.name or path.stem, links, tuple(_joint(j, warnings) for j in robot.joints)), tuple(warnings)


def _link(link: Any, path: Path, colors: dict[str, Any], warnings: list[str]) -> Link:
    inertia = Inertia()
    if link.inertial is not None and link.inertial.mass is not None:
        T = np.eye(4) if link.inertial.origin is None else link.inertial.origin
        matrix = np.zeros((3, 3)) if link.inertial.inertia is None else np.array(link.inertial.inertia, dtype=float)
        inertia = Inertia(float(link.inertial.mass), np.zeros(3), matrix).moved(T)
    shapes = [_shape(v, link.name, path, colors, False, warnings) for v in link.visuals]
    shapes += [_shape(c, link.name, path, colors, True, warnings) for c in link.collisions]
    return Link(link.name, inertia, tuple(s for s in shapes if s is not None))


def _shape(
    item: Any, link: str, path: Path, colors: dict[str, Any], collision: bool, warnings: list[str]
) -> Shape | None:
    g, T = item.geometry, np.eye(4) if item.origin is None else item.origin
    flags: dict[str, Any] = {"placement": T, "collision": collision, "visual": not collision}
    material = getattr(item, "material", None)
    color = None if material is None else (material.color or colors.get(material.name))
    if color is not None:
        flags["color"] = tuple(float(x) for x in color.rgba)
    if g is None:
        return None
    if g.box is not None:
        return Shape("box", tuple(float(x) for x in g.box.size), **flags)
    if g.cylinder is not None:
        return Shape("cylinder", (float(g.cylinder.radius), float(g.cylinder.length)), **flags)
    if g.sphere is not None:
        return Shape("sphere", (float(g.sphere.radius),), **flags)
    if g.mesh is None:
        return None
    file = find_mesh(g.mesh.filename, path)
    if file is None:
        kind = "collision" if collision else "visual"
        warnings.append(f"link {link}: the {kind} mesh {g.mesh.filename} is not there and left out")
        return None
    scale = np.ones(3) if g.mesh.scale is None else np.ones(3) * g.mesh.scale
    return Shape("mesh", tuple(float(x) for x in scale), file=str(file), **flags)


def find_mesh(name: str, urdf: Path) -> Path | None:
    """The mesh file that a URDF means: relative to it, or ``package://`` looked for in the folders above it."""
    plain = name.removeprefix("package://").removeprefix("file://").removeprefix("model://")
    folders = [urdf.resolve().parent, *urdf.resolve().parents]
    options = [plain] if "://" not in name or name.startswith("file://") else [plain, plain.partition("/")[2]]
    for option in options:
        for folder in folders:
            if (folder / option).is_file():
                return folder / option
    return None


def _joint(joint: Any, warnings: list[str]) -> Joint:
    origin = np.eye(4) if joint.origin is None else np.array(joint.origin, dtype=float)
    axis = np.array([1.0, 0.0, 0.0] if joint.axis is None else joint.axis, dtype=float)
    length = float(np.linalg.norm(axis))
    if joint.type != "fixed" and abs(length - 1.0) > 1e-4 and length > 0.0:
        warnings.append(f"joint {joint.name}: the axis had the length {length:.4g} and is normalised")
    x, y, z = axis / length if length > 0.0 else axis
    limit, dynamics = joint.limit, joint.dynamics
    lower, upper = (None, None) if limit is None else (limit.lower, limit.upper)
    kind = joint.type
    if kind == "continuous":
        # Pinocchio would take two numbers for its angle, PyBullet would read 0 and -1 for its limits.
        kind, lower, upper = "revolute", -math.pi, math.pi
        warnings.append(f"joint {joint.name}: turns without end, and is taken for ±π rad")
    if getattr(joint, "mimic", None) is not None:
        warnings.append(f"joint {joint.name}: mimic is left out, the joint is one of its own")
    return Joint(
        joint.name,
        kind,
        joint.parent,
        joint.child,
        origin,
        (float(x), float(y), float(z)),
        float(lower or 0.0),
        float(upper or 0.0),
        float((limit.effort if limit is not None else None) or 0.0),
        float((limit.velocity if limit is not None else None) or 0.0),
        float((dynamics.damping if dynamics is not None else None) or 0.0),
        float((dynamics.friction if dynamics is not None else None) or 0.0),
    )
