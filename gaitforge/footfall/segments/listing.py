"""Ties: the distinct patterns with a given number of changes, counted first, listed or sampled evenly."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import gcd

import numpy as np
from numpy.typing import NDArray

from gaitforge.footfall.segments.bound import least_times
from gaitforge.footfall.segments.counting import Choice, Completions, Flags
from gaitforge.footfall.segments.masks import Offer, offers
from gaitforge.footfall.segments.optimum import contact_of, kinds_of
from gaitforge.footfall.segments.options import options_for
from gaitforge.footfall.segments.placing import Counters, Effort, Placer, TooHard, counters_for, limb_order
from gaitforge.footfall.segments.reading import LimbType, Reading
from gaitforge.footfall.segments.rows import Rows
from gaitforge.footfall.segments.times import Times, every_set, necklaces, number_of_sets, symmetric

Contact = NDArray[np.bool_]
FEW = 40
"""Patterns listed where there are too many limbs to count."""


@dataclass(frozen=True, eq=False)
class Ties:
    """Distinct patterns; of a gait one rotation."""

    contacts: tuple[Contact, ...]
    counted: int
    """Patterns counted; rotations of a gait that begin with a change once unless its times are symmetric."""
    complete: bool
    """Whether there are no others."""


def tied_patterns(reading: Reading, most_changes: int, limit: int, largest: int, effort: int) -> Ties | None:
    """Up to about `limit` distinct patterns with Σ y ≤ `most_changes`, spread evenly over all there are.

    None when one number of times has more than `largest` sets.  `effort` bounds the counting.
    """
    kinds, kind = kinds_of(reading)
    bound = least_times(reading, [kinds[t][1] for t in kind])
    if bound is None:
        return Ties((), 0, True)
    numbers = [k for k in range(bound, most_changes + 1) if not (reading.cyclic and k == 1)]
    if any(number_of_sets(k, reading.columns, reading.cyclic) > largest for k in numbers):
        return None
    found: dict[bytes, Contact] = {}
    counted, complete, budget = 0, True, Effort(effort)
    for place, k in enumerate(numbers):
        share = max(1, (limit - len(found)) // (len(numbers) - place))
        of_k = _Tied(reading, kinds, kind, k, budget)
        complete &= of_k.count()
        counted += of_k.total
        complete &= of_k.total <= share
        for at, contact in of_k.patterns(share) if of_k.total else of_k.one_per_set(min(share, FEW)):
            found.setdefault(gait_key(contact) if of_k.symmetric[at] else contact.tobytes(), contact)
    return Ties(tuple(found.values()), counted, complete)


def gait_key(contact: Contact) -> bytes:
    """One name for all rotations of a gait: the smallest of those that begin with a change."""
    m = contact.shape[1]
    twice = np.concatenate([contact, contact], axis=1)
    begins = np.flatnonzero((twice[:, m:] != twice[:, m - 1 : 2 * m - 1]).any(axis=0))
    return min((twice[:, s : s + m].tobytes() for s in begins.tolist()), default=contact.tobytes())


def rotations(contact: Contact) -> set[bytes]:
    """All rotations of a gait."""
    m = contact.shape[1]
    twice = np.concatenate([contact, contact], axis=1)
    return {twice[:, s : s + m].tobytes() for s in range(m)}


class _Tied:
    """The patterns with exactly k change times."""

    def __init__(
        self, reading: Reading, kinds: Sequence[tuple[LimbType, Rows]], kind: Sequence[int], k: int, effort: Effort
    ) -> None:
        self.reading, self.kind, self.effort = reading, kind, effort
        self.options = options_for(k, reading.cyclic)
        self.order = [i for i, _ in limb_order(reading)]
        self.counters: Counters = counters_for(reading, self.options.segments)
        self.spread = [self.counters.spread(mask) for mask in self.options.masks]
        every = every_set(k, reading.columns, reading.cyclic)
        self.times: Times = necklaces(every, reading.columns) if reading.cyclic else every
        self.symmetric = symmetric(self.times, reading.columns) if reading.cyclic else np.zeros(len(every), dtype=bool)
        """(N,) time sets that a rotation maps onto themselves: only their gaits can be found twice."""
        self.counts: list[tuple[Offer, Completions, int]] = []
        self.total = 0
        self.most = effort.left
        self.offers = _scattered(offers(reading, kinds, self.options, self.times))

    def count(self) -> bool:
        """Count the patterns of each set of times; False when the effort was used up before the last."""
        known: dict[object, tuple[Completions, int]] = {}
        for offer in self.offers:
            key = (offer.options, offer.shortest)
            if key not in known:
                completions = self._completions(offer)
                try:
                    known[key] = completions, completions.total()
                except TooHard:
                    return False
            completions, total = known[key]
            if total:
                self.counts.append((offer, completions, total))
                self.total += total
        return True

    def _completions(self, offer: Offer) -> Completions:
        flags = Flags(self.options.times, offer.window is not None, any(t.gapped for t in self.reading.types))
        made: dict[object, list[Choice]] = {}
        choices = []
        for i in self.order:
            key = (self.kind[i], self.counters.limbs[i])
            if key not in made:
                made[key] = self._choices(i, flags, offer)
            choices.append(made[key])
        return Completions(choices, self.counters, flags, self.effort)

    def _choices(self, limb: int, flags: Flags, offer: Offer) -> list[Choice]:
        kind, gapped, unit = self.kind[limb], self.reading.types[limb].gapped, self.counters.limbs[limb]
        found, rest = [], offer.options[kind]
        while rest:
            low = rest & -rest
            option, rest = low.bit_length() - 1, rest ^ low
            shortest = bool(offer.shortest[kind] & low)
            sets = flags.of(self.options.lifts[option], self.options.lands[option], shortest, gapped)
            found.append((option, self.spread[option] * unit, sets))
        return found

    def patterns(self, limit: int) -> Iterable[tuple[int, Contact]]:
        """All of them with the rows of their times, or `limit` at even distances in the order of counting."""
        wanted = (
            np.unique(np.linspace(0, self.total - 1, min(self.total, limit)).astype(np.int64)) if self.total else ()
        )
        before, at = 0, 0
        for offer, completions, total in self.counts:
            while at < len(wanted) and wanted[at] < before + total:
                yield offer.times, self._contact(offer, completions.at(int(wanted[at]) - before))
                at += 1
            before += total

    def one_per_set(self, limit: int) -> Iterable[tuple[int, Contact]]:
        """Up to `limit` patterns of different sets of times, where counting was too much."""
        placer = Placer(self.reading, self.kind, self.options, limb_order(self.reading), Effort(self.most))
        listed = 0
        for offer in self.offers:
            try:
                placed = placer.place(offer.options) if listed < limit else None
            except TooHard:
                return
            contact = None if placed is None else contact_of(placed, self.options, *self._at(offer))
            if contact is not None and self._changes(contact) == self.options.times:
                listed += 1
                yield offer.times, contact

    def _changes(self, contact: Contact) -> int:
        following = np.roll(contact, -1, axis=1)
        changed = (contact != following).any(axis=0)
        return int(changed.sum() if self.reading.cyclic else changed[:-1].sum())

    def _at(self, offer: Offer) -> tuple[NDArray[np.intp], int]:
        return self.times[offer.times], self.reading.columns

    def _contact(self, offer: Offer, placed: Sequence[int]) -> Contact:
        options = [0] * len(placed)
        for i, option in zip(self.order, placed, strict=True):
            options[i] = option
        return contact_of(options, self.options, *self._at(offer))


def _scattered(items: Sequence[Offer]) -> list[Offer]:
    """The items in steps of about 0.38 of their number, so that a part of them is spread over all."""
    n = len(items)
    step = max(1, round(0.381966 * n))
    while gcd(step, n) > 1:
        step += 1
    return [items[i * step % n] for i in range(n)]
