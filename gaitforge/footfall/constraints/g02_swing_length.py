"""g2: how long a swing phase lasts at least."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gaitforge.footfall.constraints.phase_length import PhaseLength


@dataclass(frozen=True)
class SwingLength(PhaseLength):
    """Each swing phase lasts `at_least` columns."""

    key: ClassVar[str] = "g2"
    title: ClassVar[str] = "length of a swing phase"
    equation: ClassVar[str] = "C_ij − C_i,j+1 + C_i,j+2 ≤ 1  ∀ i, j"
    relief: ClassVar[str] = "allow shorter swing phases (g2.at_least)"
    stance: ClassVar[bool] = False
