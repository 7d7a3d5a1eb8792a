"""A task is a list of phases and a scene: plain data, no planning."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from gaitforge.robot.payload import Load
from gaitforge.task.handling import Pick, Place
from gaitforge.task.roles import Mode, Role
from gaitforge.task.scene import Scene


@dataclass(frozen=True)
class Failure:
    """Limbs that fail all at once while a phase's gait is under way, and stay so."""

    limbs: tuple[str, ...]
    """Names of limbs, or of the tools they carry"""
    mode: Mode = "locked"
    at: float | None = None
    """[-] share of a cycle that is over then, 0…1, counted from the end of the phase's own cycles; None: drawn
    from the seed"""


@dataclass(frozen=True)
class Phase:
    """One stretch of a task: who does what, how fast, for how long.

    None means: the robot's nominal value.
    """

    name: str
    kind: Literal["walk", "pick", "place"] = "walk"
    handling: Pick | Place | None = None
    """What a phase that is no walk does to an object, standing"""
    cycles: int = 2
    roles: Mapping[str, Role] = field(default_factory=dict)
    """Limb name, or name of the tool it carries → role; limbs not named are locomotive."""
    gait: str | Mapping[str, str] = "auto"
    """auto · tripod · wave · program, or a hand-written pattern: limb name → "110011…"."""
    speed: float | None = None
    """[m/s]"""
    heading: float = 0.0
    """[rad] direction of travel in the body frame, counter-clockwise from ahead"""
    yaw_rate: float = 0.0
    """[rad/s]"""
    body_height: float | None = None
    """[m] mean height of base_link above the ground"""
    roll: float = 0.0
    """[rad] mean"""
    pitch: float = 0.0
    """[rad] mean, nose down is positive"""
    step_height: float | None = None
    """[m]"""
    posture: str | Mapping[str, tuple[float, ...]] | None = None
    """How the limbs that walk stand: a posture of the robot by name, or limb → joint positions [rad]."""
    duration: float | Literal["auto"] | None = None
    """[s] of one cycle; auto: the shortest that keeps joint speeds and torques below their bounds"""
    columns: int | None = None
    """m of the cyclic pattern"""
    failure: Failure | None = None
    """What ends the phase, in the middle of one more cycle"""
    loads: tuple[Load, ...] = ()
    """What the robot carries all through the phase."""


@dataclass(frozen=True)
class Task:
    """Phases in order, and what stands around."""

    name: str
    phases: tuple[Phase, ...]
    scene: Scene = field(default_factory=Scene)
