"""g3: no stance phase of a single column."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gaitforge.footfall.constraints.phase_length import PhaseLength


@dataclass(frozen=True)
class StanceLength(PhaseLength):
    """Each stance phase lasts `at_least` columns."""

    key: ClassVar[str] = "g3"
    title: ClassVar[str] = "no stance phase of one column"
    equation: ClassVar[str] = "−C_ij + C_i,j+1 − C_i,j+2 ≤ 0  ∀ i, j"
    relief: ClassVar[str] = "allow shorter stance phases (g3.at_least)"
    stance: ClassVar[bool] = True
