"""g7: no limb swings much longer than another."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gaitforge.footfall.constraints.shared import Shared


@dataclass(frozen=True)
class SharedSwing(Shared):
    """No limb that is locomotive throughout swings more than `at_most` columns longer than another."""

    key: ClassVar[str] = "g7"
    title: ClassVar[str] = "swing shared"
    equation: ClassVar[str] = "−Σ_j C_aj + Σ_j C_bj ≤ 2  ∀ a ≠ b"
    stance: ClassVar[bool] = False
