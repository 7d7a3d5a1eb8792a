"""g6: no limb stands much longer than another."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gaitforge.footfall.constraints.shared import Shared


@dataclass(frozen=True)
class SharedStance(Shared):
    """No limb that is locomotive throughout stands more than `at_most` columns longer than another."""

    key: ClassVar[str] = "g6"
    title: ClassVar[str] = "stance shared"
    equation: ClassVar[str] = "Σ_j C_aj − Σ_j C_bj ≤ 2  ∀ a ≠ b"
    stance: ClassVar[bool] = True
