"""Picking an object up and putting it down: what a phase says about it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

GROUND = "ground"
GraspKind = Literal["friction", "weld"]
GRASPS: tuple[GraspKind, ...] = ("friction", "weld")


@dataclass(frozen=True)
class Pick:
    """Limbs reach for a box, close on its sides and lift it; they hold it until a `Place`."""

    object: str
    """Name of a box of the scene that has a mass"""
    limbs: tuple[str, ...]
    """As many on the left as on the right"""
    squeeze: float = 25.0
    """[N] of each tip that squeezes"""
    lift: float = 0.04
    """[m] from where the box stands to where it is carried"""
    grip_height: float = 0.01
    """[m] of the tips above the centre of the box"""
    grip_spread: float = 0.1
    """[m] between tips on the same side"""
    ready_aside: float = 0.05
    """[m] off the box's sides from which tips go to it and to which they go back"""
    ready_above: float = 0.06
    """[m] … and above where they touch it"""
    crouch: float = 0.0
    """[m] that the body is lower while it reaches: it rises with the load"""
    grasp: GraspKind = "friction"
    """What holds it in simulation; the verdict names a weld"""


@dataclass(frozen=True)
class Place:
    """The box is put down and let go."""

    object: str
    onto: str = GROUND
    """ground, or the name of a box that the robot stands before"""
