"""Limbs, feet and tools of a robot, as plain frozen values."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

Side = Literal["left", "right", "middle"]


@dataclass(frozen=True)
class Foot:
    """The terminal sphere that a limb walks on."""

    link: str
    """URDF link that carries the sphere."""
    offset: tuple[float, float, float]
    """Centre of the sphere in the frame of `link` [m]."""
    radius: float
    """[m]"""


@dataclass(frozen=True)
class Limb:
    """A chain that leaves the base and ends in a foot."""

    name: str
    """L1…Ln, R1…Rn, M1…Mn from front to rear."""
    side: Side
    joints: tuple[str, ...]
    """Joints from the base to the foot, in chain order; tool joints are not among them."""
    foot: Foot
    links: tuple[str, ...]
    """Every URDF link of the limb, its tools' included."""
    tools: tuple[str, ...] = ()
    """Names of the tools mounted on the limb."""
    tool_joints: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class ToolMount:
    """A gripper or camera that branches off a limb beside its foot."""

    name: str
    """Unique; what a task may call it, e.g. ``camera``."""
    kind: Literal["camera", "gripper"]
    limb: str
    link: str
    T_link_tool: np.ndarray = field(repr=False)
    """(4, 4) pose of the tool frame in `link`; a camera's is the optical frame (z ahead, x right, y down)."""
    joints: tuple[str, ...] = ()
