"""One limb lost (section III-B.1): patterns like the original, by switching and by separating swing phases."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import combinations, permutations

import numpy as np
from numpy.typing import NDArray

from gaitforge.footfall.constraints.runs import Run, runs_of
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.footfall.seam import canonical


def candidates_without(
    original: FootfallPattern, lost: str, allowed: Callable[[FootfallPattern], bool] | None = None
) -> tuple[FootfallPattern, ...]:
    """Every distinct pattern one operation away from the cyclic `original` with limb `lost` nonlocomotive.

    The first is the original with that limb free, then come *switched* and *separated* ones; `info` names
    `operation`, `limbs` and `lost`, and `also` what else leads to the same pattern.  Without `allowed` all have
    the columns of the original, whether or not the families would have them; with it, only patterns that it
    allows are given, and a separated one takes the fewest columns with which it is allowed, up to those that
    need no step to be shortened.
    """
    contact = original.contact.copy()
    contact[original.limbs.index(lost)] = False
    free = replace(original, contact=contact, source="candidate", relaxed=(), info=_info("original", lost))
    kept: dict[tuple[int, bytes], list[FootfallPattern]] = {}
    for versions in ((free,), *_switched_all(free, lost), *_separated_all(free, lost)):
        chosen = next((p for p in versions if allowed is None or allowed(p)), None)
        if chosen is not None:
            kept.setdefault((chosen.columns, canonical(chosen.contact)), []).append(chosen)
    return tuple(_once(alike) for alike in kept.values())


def switched(pattern: FootfallPattern, a: str, b: str) -> FootfallPattern:
    """The pattern in which limbs a and b take each other's swing phases."""
    i, k = pattern.limbs.index(a), pattern.limbs.index(b)
    contact = pattern.contact.copy()
    contact[[i, k]] = contact[[k, i]]
    return replace(pattern, contact=contact)


def separated(pattern: FootfallPattern, limb: str, other: str, after: bool = True) -> tuple[FootfallPattern, ...]:
    """`limb` gets a step of its own, after (or before) each swing phase of `other` that its own overlaps.

    The step takes as many columns as the swing phase had, so the pattern grows by them.  In them
    the rest swings only where it swings on both sides of the new step.
    """
    m = pattern.columns
    mine, theirs = (_swings(pattern.row(name)) for name in (limb, other))
    overlaps = [(a, b) for a in mine for b in theirs if set(a.columns(m)) & set(b.columns(m))]
    return tuple(_moved(pattern, limb, a, (b.start + b.length) % m if after else b.start) for a, b in overlaps)


def merged(pattern: FootfallPattern, columns: int) -> FootfallPattern:
    """The cyclic pattern with its steps (runs of equal columns) shortened in proportion, to `columns` in all.

    It begins with a step.  Raises ValueError when there are more steps than columns.
    """
    contact = pattern.contact
    m = pattern.columns
    starts = [j for j in range(m) if (contact[:, j] != contact[:, j - 1]).any()] or [0]
    if columns < len(starts):
        raise ValueError(f"{len(starts)} steps in {columns} columns")
    lengths = np.diff([*starts, starts[0] + m])
    parts = [contact[:, [j]] for j in starts]
    return replace(pattern, contact=np.repeat(np.hstack(parts), _shares(lengths, columns), axis=1))


def _shares(lengths: NDArray[np.int_], total: int) -> NDArray[np.int_]:
    """Integers ≥ 1 in proportion to `lengths` whose sum is `total`: largest remainders, the first of equals."""
    exact = lengths * total / lengths.sum()
    shares = np.maximum(1, np.floor(exact).astype(int))
    while shares.sum() < total:
        shares[np.argmax(exact - shares)] += 1
    while shares.sum() > total:
        shares[np.argmax(np.where(shares > 1, shares - exact, -np.inf))] -= 1
    return np.asarray(shares)


def _switched_all(free: FootfallPattern, lost: str) -> Iterator[tuple[FootfallPattern, ...]]:
    for a, b in combinations(free.locomotive, 2):
        if (free.row(a) != free.row(b)).any():
            yield (replace(switched(free, a, b), info=_info("switched", lost, a, b)),)


def _separated_all(free: FootfallPattern, lost: str) -> Iterator[tuple[FootfallPattern, ...]]:
    """Each separated pattern in all its numbers of columns, the fewest first."""
    for a, b in permutations(free.locomotive, 2):
        for long in (*separated(free, a, b, after=True), *separated(free, a, b, after=False)):
            named = replace(long, info=_info("separated", lost, a, b))
            yield tuple(merged(named, columns) for columns in range(free.columns, long.columns + 1))


def _once(alike: list[FootfallPattern]) -> FootfallPattern:
    """The first of patterns that are rotations of each other; it says what else leads to it."""
    first, *others = alike
    also = tuple(dict.fromkeys((p.info["operation"], *p.info["limbs"]) for p in others))
    return replace(first, info={**first.info, "also": also})


def _info(operation: str, lost: str, *limbs: str) -> dict[str, object]:
    return {"operation": operation, "lost": lost, "limbs": limbs}


def _swings(row: NDArray[np.bool_]) -> list[Run]:
    """Whole swing phases of a cyclic row (m,)."""
    return [run for run in runs_of(row, True) if run.whole and not run.stance]


def _moved(pattern: FootfallPattern, limb: str, swing: Run, edge: int) -> FootfallPattern:
    """The swing phase taken out, and columns put in before column `edge` in which the limb swings instead."""
    i, contact = pattern.limbs.index(limb), pattern.contact.copy()
    contact[i, list(swing.columns(pattern.columns))] = True
    step = contact[:, edge - 1] | contact[:, edge]  # (n_F,)
    step[i] = False
    block = np.repeat(step[:, None], swing.length, axis=1)
    return replace(pattern, contact=np.hstack([contact[:, :edge], block, contact[:, edge:]]))
