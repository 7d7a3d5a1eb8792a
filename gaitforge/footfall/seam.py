"""Where a cyclic pattern begins: rotations, and the seam at which a robot can start and stop."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitforge.footfall.pattern import FootfallPattern


def airborne(contact: NDArray[np.bool_]) -> NDArray[np.int_]:
    """(m,) how many walking limbs are in the air at t_j of a cyclic pattern (n_F, m).

    Contact is held over intervals: a foot is on the ground at t_j when C_ij = 1 or C_i,j−1 = 1.
    """
    walking = contact[contact.any(axis=1)]
    return np.asarray((~(walking | np.roll(walking, 1, axis=1))).sum(axis=0))


def at_grounded_seam(pattern: FootfallPattern) -> FootfallPattern:
    """The same gait, begun where every walking limb is on the ground; where the fewest are in the air if none is.

    The first such column is taken, so a pattern that already begins well stays as it is.
    """
    if not pattern.cyclic:
        return pattern
    columns = int(np.argmin(airborne(pattern.contact)))
    return pattern.rotated(columns) if columns else pattern


def canonical(contact: NDArray[np.bool_]) -> bytes:
    """One name for all rotations of a cyclic pattern: the smallest of them, column by column."""
    columns = [tuple(column) for column in contact.T.tolist()]
    m = len(columns)
    smallest = min(columns[k:] + columns[:k] for k in range(m))
    return np.array(smallest, dtype=bool).tobytes()


def distinct_gaits(contacts: tuple[NDArray[np.bool_], ...]) -> list[NDArray[np.bool_]]:
    """Each gait once, whatever column it was written from; the first of its rotations is kept."""
    kept: dict[bytes, NDArray[np.bool_]] = {}
    for contact in contacts:
        kept.setdefault(canonical(contact), contact)
    return list(kept.values())
