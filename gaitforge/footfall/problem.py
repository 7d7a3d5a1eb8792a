"""`FootfallProblem`: everything the search for a contact pattern may know."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class FootfallProblem:
    """A cyclic gait pattern, or a transition between two columns, for limbs with given roles."""

    limbs: tuple[str, ...]
    """Row names, L1…Ln, R1…Rn."""
    sides: tuple[str, ...]
    """left · right · middle, per row."""
    columns: int
    """m"""
    cyclic: bool = True
    locomotive_before: tuple[str, ...] = ()
    """Limbs that walk in the gait before (in a cyclic problem: in the gait itself)."""
    locomotive_after: tuple[str, ...] = ()
    """Limbs that walk in the gait after (in a cyclic problem the same as before)."""
    first: NDArray[np.bool_] | None = None
    """(n_F,) fixed first column of a transition; None when cyclic."""
    last: NDArray[np.bool_] | None = None
    """(n_F,) fixed last column of a transition."""
    footholds: NDArray[np.float64] | None = None
    """(n_F, 2) nominal footholds in the base frame [m]."""
    center_of_mass: NDArray[np.float64] = field(default_factory=lambda: np.zeros(2))
    """(2,) its projection in the base frame [m]."""
    parameters: dict[str, Any] = field(default_factory=dict)

    @property
    def locomotive_anywhere(self) -> tuple[str, ...]:
        """Limbs that walk before or after."""
        union = set(self.locomotive_before) | set(self.locomotive_after)
        return tuple(n for n in self.limbs if n in union)

    @property
    def locomotive_throughout(self) -> tuple[str, ...]:
        """Limbs that walk before and after."""
        both = set(self.locomotive_before) & set(self.locomotive_after)
        return tuple(n for n in self.limbs if n in both)
