"""Modules: the hardware a robot is bolted together from, as frozen values."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from gaitforge.robot.geometry import Array, Inertia, Shape
from gaitforge.robot.limbs import Foot

KINDS = ("chassis", "actuator", "bracket", "tube", "foot", "gripper", "camera")
GENDERS = ("male", "female", "neutral")
JOINT_TYPES = ("revolute", "continuous")


@dataclass(frozen=True, eq=False)
class Port:
    """Where another module is bolted on: z points out of the module (of its ``in`` port: into it)."""

    name: str
    body: str
    T: Array
    """(4, 4) in the body frame"""
    type: str
    """Mechanical interface, e.g. ``sea``; only equal types fit."""
    gender: str
    """male · female · neutral; opposite ones fit, and neutral with neutral."""
    clocking: tuple[float, ...] | None
    """Allowed turns about z [rad]; None: any."""

    def allows(self, angle: float) -> bool:
        """May the other module be turned by `angle` [rad]?"""
        if self.clocking is None:
            return True
        return any(abs(math.remainder(angle - a, 2.0 * math.pi)) < 1e-4 for a in self.clocking)


@dataclass(frozen=True, eq=False)
class ModuleJoint:
    """The actuated joint of a module: between its first body and the body `child`."""

    type: str
    parent: str
    child: str
    T: Array
    """(4, 4) joint (and child body) frame in the parent body's"""
    axis: tuple[float, float, float]
    lower: float
    """[rad]"""
    upper: float
    effort: float
    """[N m]"""
    velocity: float
    """[rad/s]"""
    damping: float = 0.0
    """[N m s/rad]"""
    friction: float = 0.0
    """[N m]"""


@dataclass(frozen=True, eq=False)
class Body:
    """One rigid part of a module."""

    name: str
    inertia: Inertia
    shapes: tuple[Shape, ...]


@dataclass(frozen=True, eq=False)
class Module:
    """One piece of hardware, with its parameters (a tube's length, …) put in."""

    name: str
    kind: str
    source: str
    file: str
    bodies: tuple[Body, ...]
    ports: Mapping[str, Port]
    joint: ModuleJoint | None = None
    foot: Foot | None = None
    """`foot.link` is the body."""
    frames: Mapping[str, tuple[str, Array]] = field(default_factory=dict)
    """Named frames, e.g. a camera's ``optical``: body, (4, 4)."""
    mirror: str = ""
    """Module that takes its place in a mirrored limb; empty: itself."""
    parameters: Mapping[str, float] = field(default_factory=dict)
    handed: tuple[str, ...] = ()
    """Parameters that change sign in a mirrored limb, e.g. a twist."""


def is_mirror_image(one: Module, other: Module) -> bool:
    """Do the ports and the joint of `other` lie where those of `one` do, seen in a mirror along x and z?"""
    S = np.diag([1.0, -1.0, 1.0, 1.0])
    pairs = [(p.T, other.ports[n].T) for n, p in one.ports.items() if n in other.ports]
    if one.joint is not None and other.joint is not None:
        pairs.append((one.joint.T, other.joint.T))
    whole = set(one.ports) == set(other.ports) and (one.joint is None) == (other.joint is None)
    return whole and all(bool(np.allclose(S @ T @ S, T_other, atol=1e-6)) for T, T_other in pairs)
