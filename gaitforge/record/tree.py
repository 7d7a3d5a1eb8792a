"""The tree of a URDF's links and, in bulk, where they are: what `/tf` needs at every stamp.

A transform from a link to its parent depends on one joint alone, so n stamps are one NumPy
expression per joint; Pinocchio's forward kinematics, which gives world poses, is the check.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitforge.robot.rotation import quaternions

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Edge:
    """A joint of the URDF: where `child` sits in `parent`."""

    parent: str
    child: str
    joint: str
    kind: str
    """URDF joint type"""
    origin: Array
    """(3,) [m]"""
    rotation: Array
    """(4,) x, y, z, w at the joint's zero"""
    axis: Array
    """(3,) unit, in the joint frame"""

    def poses(self, values: Array) -> Array:
        """(n, 7) x, y, z [m] and quaternion x, y, z, w of the child in the parent for n joint positions."""
        pose = np.empty((len(values), 7))
        pose[:, :3], pose[:, 3:] = self.origin, self.rotation
        if self.kind in ("revolute", "continuous"):
            pose[:, 3:] = multiply(self.rotation, about(self.axis, values))
        elif self.kind == "prismatic":
            pose[:, :3] += values[:, None] * rotate(self.rotation, self.axis)
        return pose


@dataclass(frozen=True, eq=False)
class LinkTree:
    """The links of a URDF, parents before children."""

    root: str
    edges: tuple[Edge, ...]

    @staticmethod
    def of(urdf: str) -> LinkTree:
        """The tree of a URDF text."""
        robot = ET.fromstring(urdf)
        edges = {edge.child: edge for edge in (_edge(joint) for joint in robot.findall("joint"))}
        order: list[str] = [link.attrib["name"] for link in robot.findall("link") if link.attrib["name"] not in edges]
        root = order[0]
        for name in order:
            order += [child for child, edge in edges.items() if edge.parent == name]
        return LinkTree(root, tuple(edges[name] for name in order[1:]))

    @property
    def links(self) -> tuple[str, ...]:
        """Every link, the root first."""
        return (self.root, *(edge.child for edge in self.edges))

    def relative(self, joint_names: Sequence[str], positions: Array) -> Array:
        """(n, L − 1, 7) each link but the root in its parent, for (n, n_J) positions; other joints rest at 0."""
        rows = {name: k for k, name in enumerate(joint_names)}
        still = np.zeros(len(positions))
        poses = [e.poses(positions[:, rows[e.joint]] if e.joint in rows else still) for e in self.edges]
        return np.stack(poses, axis=1) if poses else np.empty((len(positions), 0, 7))

    def world(self, base: Array, relative: Array) -> dict[str, Array]:
        """Link → (n, 7) pose in the world, from (n, 6) poses of the root and what `relative` gave."""
        poses = {self.root: base_to_pose(base)}
        for k, edge in enumerate(self.edges):
            parent, local = poses[edge.parent], relative[:, k]
            pose = np.empty_like(parent)
            pose[:, :3] = parent[:, :3] + rotate(parent[:, 3:], local[:, :3])
            pose[:, 3:] = multiply(parent[:, 3:], local[:, 3:])
            poses[edge.child] = pose
        return poses


def base_to_pose(base: ArrayLike) -> Array:
    """(n, 7) position and quaternion of (n, 6) poses x, y, z, roll, pitch, yaw (R = Rz Ry Rx)."""
    poses = np.atleast_2d(np.asarray(base, dtype=float))
    return np.hstack([poses[:, :3], quaternions(poses[:, 3:])])


def about(axis: Array, angles: Array) -> Array:
    """(n, 4) quaternions of turns by `angles` [rad] about a unit axis."""
    half = np.asarray(angles, dtype=float) / 2.0
    return np.hstack([np.sin(half)[:, None] * axis, np.cos(half)[:, None]])


def multiply(p: Array, q: Array) -> Array:
    """Quaternion product of x, y, z, w in the last axis."""
    pv, pw, qv, qw = p[..., :3], p[..., 3:], q[..., :3], q[..., 3:]
    vector = pw * qv + qw * pv + np.cross(pv, qv)
    scalar = pw * qw - np.sum(pv * qv, axis=-1, keepdims=True)
    return np.concatenate([vector, scalar], axis=-1)


def rotate(q: Array, v: Array) -> Array:
    """Vectors turned by quaternions."""
    twice = 2.0 * np.cross(q[..., :3], v)
    return np.asarray(v + q[..., 3:] * twice + np.cross(q[..., :3], twice))


def matrix_to_quaternion(rotation: Array) -> Array:
    """(4,) x, y, z, w of a (3, 3) rotation."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_matrix(rotation).as_quat())


def _edge(joint: ET.Element) -> Edge:
    origin, axis = joint.find("origin"), joint.find("axis")
    rpy = _numbers(origin, "rpy", (0.0, 0.0, 0.0))
    vector = _numbers(axis, "xyz", (1.0, 0.0, 0.0))
    return Edge(
        parent=_link(joint, "parent"),
        child=_link(joint, "child"),
        joint=joint.attrib["name"],
        kind=joint.attrib["type"],
        origin=_numbers(origin, "xyz", (0.0, 0.0, 0.0)),
        rotation=base_to_pose(np.concatenate([np.zeros(3), rpy]))[0, 3:],
        axis=vector / (np.linalg.norm(vector) or 1.0),
    )


def _link(joint: ET.Element, role: str) -> str:
    element = joint.find(role)
    if element is None:
        raise ValueError(f"joint {joint.get('name')} has no {role}")
    return element.attrib["link"]


def _numbers(element: ET.Element | None, key: str, default: tuple[float, ...]) -> Array:
    text = element.get(key) if element is not None else None
    return np.array([float(x) for x in text.split()] if text else default)
