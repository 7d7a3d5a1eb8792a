"""g4: no stance phase of two columns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gaitforge.footfall.constraints.phase_length import PhaseLength


@dataclass(frozen=True)
class StancePair(PhaseLength):
    """No stance phase of 2 … `at_least` − 1 columns; one column is g3's."""

    key: ClassVar[str] = "g4"
    title: ClassVar[str] = "no stance phase of two columns"
    equation: ClassVar[str] = "−C_ij + C_i,j+1 + C_i,j+2 − C_i,j+3 ≤ 1  ∀ i, j"
    relief: ClassVar[str] = "allow shorter stance phases (g4.at_least)"
    stance: ClassVar[bool] = True
    shortest: ClassVar[int] = 2

    at_least: int = 3
    """[columns]"""
