"""g9: some left limb is in stance in every column."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gaitforge.footfall.constraints.sides import SideStance


@dataclass(frozen=True)
class LeftStance(SideStance):
    """At least `at_least` left limbs are in stance in every column."""

    key: ClassVar[str] = "g9"
    title: ClassVar[str] = "left limbs in stance"
    equation: ClassVar[str] = "Σ_{i left} C_ij ≥ 1  ∀ j"
    relief: ClassVar[str] = "keep another left limb locomotive"
    who: ClassVar[str] = "left limbs"
    side: ClassVar[str] = "left"
