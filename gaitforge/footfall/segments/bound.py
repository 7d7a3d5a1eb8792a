"""A lower bound on the number of change times."""

from __future__ import annotations

from collections.abc import Sequence

from gaitforge.footfall.segments.reading import Reading
from gaitforge.footfall.segments.rows import Rows


def least_times(reading: Reading, rows: Sequence[Rows]) -> int | None:
    """No pattern has fewer change times than this; None when there is no pattern at all.

    Of the limbs of a clause, at most cap swing in a segment.  With n those that have to step inside (all
    that cannot stand throughout in a gait; those fixed to stance at both ends in a transition):
    k ≥ ⌈n / cap⌉ in a gait, 1 + ⌈n / cap⌉ in a transition, whose first and last segment are not theirs.
    Under the gap rule they lift at no more than cap a time, and land at others: k ≥ 2 ⌈n / cap⌉.
    There is no pattern when their shortest swings need more than cap times the columns they may swing in,
    or when more than cap of them have to swing in one column.
    """
    if any(reading.asks_too_much(column) for column in range(reading.columns)):
        return None
    if any(not (r.swing.any() or r.stance.any() or r.always_stance or r.always_swing) for r in rows):
        return None
    stepping = [_steps(reading, r) for r in rows]
    distinct = {id(r): r for r, steps in zip(rows, stepping, strict=True) if steps}
    shortest = {key: _shortest(reading, r) for key, r in distinct.items()}
    open_columns = reading.columns if reading.cyclic else reading.columns - 2
    bound = _by_ends(reading, rows)
    everyone = (frozenset(range(len(rows))), len(rows))
    for limbs, cap in (everyone, *reading.clauses):
        inside = [i for i in limbs if stepping[i]]
        if cap < 0 or (inside and cap < 1):
            return None
        if not inside:
            continue
        if sum(shortest[id(rows[i])] for i in inside) > cap * open_columns:
            return None
        needed = -(-len(inside) // cap)
        bound = max(bound, needed if reading.cyclic else 1 + needed, 2)
        gapped = sum(reading.types[i].gapped for i in inside)
        bound = max(bound, 2 * -(-gapped // cap))
    return bound


def _steps(reading: Reading, rows: Rows) -> bool:
    """Whether such a limb both lifts and lands in every pattern."""
    if rows.always_stance or rows.always_swing:
        return False
    m = reading.columns
    return reading.cyclic or not (rows.stance.any() or rows.swing[0].any() or rows.swing[:, m].any())


def _shortest(reading: Reading, rows: Rows) -> int:
    """Columns of the shortest swing of a limb that steps."""
    start, end = rows.swing.nonzero()
    return int(((end - start) % reading.columns).min())


def _by_ends(reading: Reading, rows: Sequence[Rows]) -> int:
    """1 when some limb of a transition changes at all."""
    changing = any(not (r.always_stance or r.always_swing or r.swing[0, reading.columns]) for r in rows)
    return int(not reading.cyclic and changing)
