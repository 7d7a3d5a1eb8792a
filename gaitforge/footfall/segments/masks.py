"""Which masks each type of limb may take, for every set of change times at once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitforge.footfall.segments.options import Options
from gaitforge.footfall.segments.reading import LimbType, Reading
from gaitforge.footfall.segments.rows import Rows
from gaitforge.footfall.segments.times import Times

WORD = 62
"""Options per 64-bit integer."""
CHUNK = 400_000
"""Most pairs of time set and window looked at at once."""


@dataclass(frozen=True)
class Availability:
    """What one or more time sets offer: per type the options it may take, as bits."""

    options: tuple[int, ...]
    times: int
    """Row of the first such time set."""
    window: int | None
    """Shortest swing of the balanced limbs, when they are compared."""


def windows(reading: Reading) -> NDArray[np.intp]:
    """(W,) shortest swing times worth trying: the balanced limbs of a clause swing w each, cap · m in all at most."""
    m = reading.columns
    balanced = frozenset(i for i, t in enumerate(reading.types) if t.balanced)
    longest = m
    for limbs, cap in reading.clauses:
        if asked := len(limbs & balanced):
            longest = min(longest, max(cap, 0) * m // asked)
    return np.arange(longest + 1)


def availabilities(
    reading: Reading, kinds: Sequence[tuple[LimbType, Rows]], options: Options, times: Times
) -> Iterator[Availability]:
    """Every distinct availability of the time sets (N, k), in blocks, those with most options first in each."""
    frames = windows(reading) if reading.spread is not None else None
    step = max(1, CHUNK // (1 if frames is None else len(frames)))
    for start in range(0, len(times), step):
        yield from _block(reading, kinds, options, times[start : start + step], start, frames)


def _block(
    reading: Reading,
    kinds: Sequence[tuple[LimbType, Rows]],
    options: Options,
    times: Times,
    start: int,
    frames: NDArray[np.intp] | None,
) -> list[Availability]:
    words = _words(reading, kinds, options, times, frames, reading.spread)
    flat = _usable(words, len(times), frames)
    if not len(flat):
        return []
    columns = [_column(word, flat, len(times)) for packed in words for word in packed]
    found = []
    for row in _distinct(columns):
        frame, which = divmod(int(flat[row]), len(times))
        bits = _joined(words, [int(column[row]) for column in columns])
        found.append(Availability(bits, start + which, None if frames is None else int(frames[frame])))
    return sorted(found, key=lambda a: -sum(b.bit_count() for b in a.options))


@dataclass(frozen=True)
class Offer:
    """What one time set offers for one shortest swing, for counting."""

    options: tuple[int, ...]
    """Per type the options it may take, as bits."""
    shortest: tuple[int, ...]
    """Per type those that swing for exactly the shortest time, 0 for types that are not compared."""
    times: int
    window: int | None


def offers(reading: Reading, kinds: Sequence[tuple[LimbType, Rows]], options: Options, times: Times) -> list[Offer]:
    """One per time set (N, k) and shortest swing for which every type has an option."""
    frames = windows(reading) if reading.spread is not None else None
    words = _words(reading, kinds, options, times, frames, reading.spread)
    exact = _words(reading, kinds, options, times, frames, 0)
    flat = _usable(words, len(times), frames)
    rows = np.stack([_column(word, flat, len(times)) for packed in words for word in packed], axis=1).tolist()
    short = np.stack([_column(word, flat, len(times)) for packed in exact for word in packed], axis=1).tolist()
    found = []
    for at, row, least in zip(flat.tolist(), rows, short, strict=True):
        frame, which = divmod(at, len(times))
        shortest = tuple(
            bits if limb_type.balanced else 0 for bits, (limb_type, _) in zip(_joined(exact, least), kinds, strict=True)
        )
        window = None if frames is None else int(frames[frame])
        if window is None or any(shortest):
            found.append(Offer(_joined(words, row), shortest, which, window))
    return found


Words = list[list[NDArray[np.int64]]]
"""Per type the options as bits, 62 a word, each word (1, N) or (W, N)."""


def _words(
    reading: Reading,
    kinds: Sequence[tuple[LimbType, Rows]],
    options: Options,
    times: Times,
    frames: NDArray[np.intp] | None,
    spread: int | None,
) -> Words:
    lengths = swing_lengths(options, times, reading.columns) if frames is not None else None
    found = []
    for limb_type, rows in kinds:
        allowed = allowed_options(rows, options, times, reading.columns)
        found.append(_packed(allowed, lengths if limb_type.balanced else None, frames, spread))
    return found


def _usable(words: Words, count: int, frames: NDArray[np.intp] | None) -> NDArray[np.intp]:
    """Pairs of window and time set, numbered row by row, for which every type has an option."""
    usable = np.ones((1 if frames is None else len(frames), count), dtype=bool)
    for packed in words:
        usable &= np.logical_or.reduce([word != 0 for word in packed])
    return np.flatnonzero(usable)


def _column(word: NDArray[np.int64], flat: NDArray[np.intp], count: int) -> NDArray[np.int64]:
    """(R,) a word at the pairs `flat`; one row of it says the same for every window."""
    found: NDArray[np.int64] = word.reshape(-1)[flat if word.shape[0] > 1 else flat % count]
    return found


def _joined(words: Words, values: Sequence[int]) -> tuple[int, ...]:
    """Per type one integer out of its words."""
    if all(len(packed) == 1 for packed in words):
        return tuple(values)
    at = iter(values)
    return tuple(sum(next(at) << (WORD * w) for w in range(len(packed))) for packed in words)


def allowed_options(rows: Rows, options: Options, times: Times, m: int) -> NDArray[np.bool_]:
    """(N, O) whether the rows of a type allow each option at each time set."""
    at = times if options.cyclic else with_ends(times, m)
    constant = [rows.always_stance, rows.always_swing] if options.cyclic else [rows.always_stance]
    return np.concatenate(
        [
            rows.swing[at[:, options.swing_from], at[:, options.swing_to]],
            rows.stance[at[:, options.stance_from], at[:, options.stance_to]],
            np.tile(np.array(constant, dtype=bool), (len(times), 1)),
        ],
        axis=1,
    )


def swing_lengths(options: Options, times: Times, m: int) -> NDArray[np.intp]:
    """(N, O) columns in swing."""
    at = times if options.cyclic else with_ends(times, m)
    swing = at[:, options.swing_to] - at[:, options.swing_from]
    if options.cyclic:
        swing = swing % m
    stance = m - (at[:, options.stance_to] - at[:, options.stance_from])
    constant = np.tile(np.array([0, m] if options.cyclic else [0]), (len(times), 1))
    return np.concatenate([swing, stance, constant], axis=1)


def with_ends(times: Times, m: int) -> Times:
    """(N, k + 2) the times of a transition with its ends 0 and m."""
    column = np.ones((len(times), 1), dtype=np.intp)
    return np.concatenate([0 * column, times, m * column], axis=1)


def _packed(
    allowed: NDArray[np.bool_], lengths: NDArray[np.intp] | None, frames: NDArray[np.intp] | None, spread: int | None
) -> list[NDArray[np.int64]]:
    """Options as bits, (1, N) or (W, N) where swing lengths have to lie in the window."""
    compared = lengths is not None and frames is not None and spread is not None
    shape = (len(frames) if compared and frames is not None else 1, len(allowed))
    words = [np.zeros(shape, dtype=np.int64) for _ in range(-(-allowed.shape[1] // WORD))]
    for o in np.flatnonzero(allowed.any(axis=0)):
        fits = allowed[None, :, o]
        if lengths is not None and frames is not None and spread is not None:
            over = lengths[None, :, o] - frames[:, None]
            fits = fits & (over >= 0) & (over <= spread)
        words[o // WORD] |= fits.astype(np.int64) << np.int64(o % WORD)
    return words


def _distinct(columns: Sequence[NDArray[np.int64]]) -> list[int]:
    """Rows at which each distinct combination of the columns occurs first."""
    ids = np.zeros(len(columns[0]), dtype=np.int64)
    for column in columns:
        if column[0] == column[-1] and (column == column[0]).all():
            continue
        values, inverse = np.unique(column, return_inverse=True)
        _, ids = np.unique(ids * len(values) + inverse, return_inverse=True)
    _, first = np.unique(ids, return_index=True)
    return [int(i) for i in np.sort(first)]
