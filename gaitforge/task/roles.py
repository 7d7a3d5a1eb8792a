"""What a limb is for during a phase: locomotive, held, failed or a tool."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Locomotive:
    """The limb walks."""


@dataclass(frozen=True)
class Held:
    """The limb keeps a posture (joint positions [rad], the robot's held posture by default)."""

    posture: tuple[float, ...] | None = None


Mode = Literal["locked", "limp"]
"""What a failed limb does: its joints are locked where they are, or turn freely but for their friction."""
MODES: tuple[Mode, ...] = ("locked", "limp")


@dataclass(frozen=True)
class Failed:
    """The limb does what it is told no more.

    `posture`: its joint positions [rad], where it is locked or how it hangs; None: the robot's held posture.
    """

    mode: Mode = "locked"
    posture: tuple[float, ...] | None = None


@dataclass(frozen=True)
class Tool:
    """The limb follows a target with the tool it carries.

    `look_at`: a point [m], or the name of a point of the scene ("pipe.opening"), that the camera's
    optical axis goes through; `frame` says in which frame the point is given.
    """

    look_at: tuple[float, float, float] | str
    frame: Literal["world", "body"] = "world"

    def __post_init__(self) -> None:
        if not isinstance(self.look_at, str):
            object.__setattr__(self, "look_at", _point(self.look_at))


def _point(values: Sequence[float]) -> tuple[float, float, float]:
    if len(values) != 3:
        raise ValueError(f"look_at has three coordinates [m], found {len(values)}")
    x, y, z = (float(v) for v in values)
    return x, y, z


@dataclass(frozen=True)
class Carry:
    """The limb holds a load together with others: a closed chain that does not move in the body frame."""

    object: str
    """Name of the load"""


Role = Locomotive | Held | Failed | Tool | Carry
