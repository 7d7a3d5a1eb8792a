"""The footfall pattern C: which limb is in stance during which interval."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

Source = Literal["given", "candidate", "program", "wave", "interpolated"]


@dataclass(frozen=True, eq=False)
class FootfallPattern:
    """C of the paper: (n_F, m), True = stance, False = swing; column j speaks of the interval [t_j, t_j+1)."""

    contact: NDArray[np.bool_]
    """(n_F, m)"""
    limbs: tuple[str, ...]
    """Row names, L1…Ln, R1…Rn."""
    cyclic: bool = True
    source: Source = "given"
    relaxed: tuple[str, ...] = ()
    """What had to be relaxed for this pattern to exist, in words."""
    info: Mapping[str, Any] = field(default_factory=dict)
    """What the solver said: status, bound, build_s, solve_s, solver, …"""

    def __post_init__(self) -> None:
        contact = np.array(self.contact, dtype=bool, ndmin=2)
        if contact.shape[0] != len(self.limbs):
            raise ValueError(f"a pattern of {contact.shape[0]} rows for {len(self.limbs)} limbs")
        contact.setflags(write=False)
        object.__setattr__(self, "contact", contact)
        object.__setattr__(self, "limbs", tuple(self.limbs))

    @property
    def columns(self) -> int:
        """m"""
        return int(self.contact.shape[1])

    @property
    def locomotive(self) -> tuple[str, ...]:
        """Limbs with at least one stance column."""
        return tuple(n for n, row in zip(self.limbs, self.contact, strict=True) if row.any())

    @property
    def changes(self) -> int:
        """Σ y: number of column boundaries at which some limb changes (the cyclic wrap included when cyclic)."""
        following = np.roll(self.contact, -1, axis=1) if self.cyclic else self.contact[:, 1:]
        present = self.contact if self.cyclic else self.contact[:, :-1]
        return int((present != following).any(axis=0).sum())

    def rotated(self, columns: int) -> FootfallPattern:
        """The same gait begun `columns` later."""
        return replace(self, contact=np.roll(self.contact, -columns, axis=1))

    def row(self, limb: str) -> NDArray[np.bool_]:
        """(m,) the row of one limb."""
        row: NDArray[np.bool_] = self.contact[self.limbs.index(limb)]
        return row

    @staticmethod
    def from_rows(rows: Mapping[str, Sequence[int] | str], cyclic: bool = True) -> FootfallPattern:
        """A hand-written pattern: limb name → "110011…" or a list of 0/1."""
        contact = np.array([[str(c) == "1" for c in row] for row in rows.values()])
        return FootfallPattern(contact, tuple(rows), cyclic)
