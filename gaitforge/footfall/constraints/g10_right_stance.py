"""g10: some right limb is in stance in every column."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gaitforge.footfall.constraints.sides import SideStance


@dataclass(frozen=True)
class RightStance(SideStance):
    """At least `at_least` right limbs are in stance in every column."""

    key: ClassVar[str] = "g10"
    title: ClassVar[str] = "right limbs in stance"
    equation: ClassVar[str] = "Σ_{i right} C_ij ≥ 1  ∀ j"
    relief: ClassVar[str] = "keep another right limb locomotive"
    who: ClassVar[str] = "right limbs"
    side: ClassVar[str] = "right"
