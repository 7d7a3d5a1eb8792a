"""URDF text from a tree of links, the same bytes for the same robot."""

from __future__ import annotations

import io
from typing import Any

import numpy as np

from gaitforge.robot.geometry import Shape, clean
from gaitforge.robot.tree import Joint, Link, RigidTree

MAX_LINKS = 127
"""PyBullet answers no state call for a body with more joints than this."""


def urdf_text(tree: RigidTree) -> str:
    """The URDF of a tree: pretty-printed (PyBullet refuses one long line), metres, kilograms, radians."""
    import yourdfpy

    robot = yourdfpy.Robot(
        name=tree.name, links=[_link(x) for x in tree.links], joints=[_joint(x) for x in tree.joints]
    )
    writer = yourdfpy.URDF(robot, build_scene_graph=False, load_meshes=False)
    text = io.BytesIO()
    writer.write_xml().write(text, pretty_print=True, xml_declaration=True, encoding="utf-8")
    return text.getvalue().decode("utf-8")


def _link(link: Link) -> Any:
    import yourdfpy

    inertial = None
    if link.inertia.mass > 0.0:
        origin = np.eye(4)
        origin[:3, 3] = link.inertia.com
        matrix = np.round(link.inertia.matrix, 15) + 0.0
        inertial = yourdfpy.Inertial(origin=clean(origin), mass=float(round(link.inertia.mass, 12)), inertia=matrix)
    visuals = [_visual(link, i, s) for i, s in enumerate(link.shapes) if s.visual]
    collisions = [_collision(s) for s in link.shapes if s.collision]
    return yourdfpy.Link(name=link.name, inertial=inertial, visuals=visuals, collisions=collisions)


def _visual(link: Link, index: int, shape: Shape) -> Any:
    import yourdfpy

    material = None
    if shape.color is not None:
        name = "rgba_" + "_".join(f"{round(255 * c):02x}" for c in shape.color)
        material = yourdfpy.Material(name=name, color=yourdfpy.Color(rgba=np.array(shape.color)))
    return yourdfpy.Visual(origin=clean(shape.placement), geometry=_geometry(shape), material=material)


def _collision(shape: Shape) -> Any:
    import yourdfpy

    return yourdfpy.Collision(name=None, origin=clean(shape.placement), geometry=_geometry(shape))


def _geometry(shape: Shape) -> Any:
    import yourdfpy

    if shape.kind == "box":
        return yourdfpy.Geometry(box=yourdfpy.Box(size=np.array(shape.size)))
    if shape.kind == "cylinder":
        return yourdfpy.Geometry(cylinder=yourdfpy.Cylinder(radius=shape.size[0], length=shape.size[1]))
    if shape.kind == "sphere":
        return yourdfpy.Geometry(sphere=yourdfpy.Sphere(radius=shape.size[0]))
    return yourdfpy.Geometry(mesh=yourdfpy.Mesh(filename=shape.file, scale=np.array(shape.size)))


def _joint(joint: Joint) -> Any:
    import yourdfpy

    return yourdfpy.Joint(
        name=joint.name,
        type=joint.type,
        parent=joint.parent,
        child=joint.child,
        origin=clean(joint.origin),
        axis=np.array(joint.axis),
        dynamics=yourdfpy.Dynamics(damping=joint.damping, friction=joint.friction),
        limit=yourdfpy.Limit(effort=joint.effort, velocity=joint.velocity, lower=joint.lower, upper=joint.upper),
    )
