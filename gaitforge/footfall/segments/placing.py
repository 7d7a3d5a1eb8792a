"""One mask of segments per limb: the limbs of each class placed by memoised depth-first search."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gaitforge.footfall.segments.options import Options
from gaitforge.footfall.segments.reading import Reading


class TooHard(Exception):
    """The search has used up its effort."""


@dataclass(eq=False)
class Effort:
    """How many limbs may still be tried with a mask; counted, not timed, so that a result can be had again."""

    left: int

    def spend(self) -> None:
        """One more; raises TooHard when there is none left."""
        self.left -= 1
        if self.left < 0:
            raise TooHard


@dataclass(frozen=True)
class Counters:
    """How many limbs of each clause swing in each segment, all in one integer.

    One counter per clause and segment, begun so that its top bit is set as soon as it passes the cap.
    """

    start: int
    guard: int
    """The top bits"""
    limbs: tuple[int, ...]
    """Per limb, what it adds for the first segment."""
    width: int

    def spread(self, mask: int) -> int:
        """A mask of segments as one 1 per counter of the first clause; times `limbs` it is what a limb adds."""
        total, segment = 0, 0
        while mask:
            if mask & 1:
                total |= 1 << (segment * self.width)
            mask, segment = mask >> 1, segment + 1
        return total


def counters_for(reading: Reading, segments: int) -> Counters:
    """The counters of the clauses that can be broken at all."""
    clauses = [(limbs, cap) for limbs, cap in reading.clauses if cap < len(limbs)]
    width = max((cap + 1 for _, cap in clauses), default=1).bit_length() + 1
    limbs, start, guard = [0] * len(reading.types), 0, 0
    for c, (members, cap) in enumerate(clauses):
        place = c * segments * width
        for i in members:
            limbs[i] |= 1 << place
        for s in range(segments):
            start |= ((1 << (width - 1)) - 1 - cap) << (place + s * width)
            guard |= 1 << (place + s * width + width - 1)
    return Counters(start, guard, tuple(limbs), width)


def limb_order(reading: Reading) -> tuple[tuple[int, int], ...]:
    """(limb, class) in the order of placing: tight clauses first, and those begun are finished first.

    Limbs of a class have the same type and stand in the same clauses.
    """
    member = [tuple(c for c, (limbs, _) in enumerate(reading.clauses) if i in limbs) for i in range(len(reading.types))]
    classes: dict[object, list[int]] = {}
    for i, limb_type in enumerate(reading.types):
        classes.setdefault((limb_type, member[i]), []).append(i)
    groups = list(classes.values())
    inside = np.zeros((len(groups), len(reading.clauses) + 1))
    for g, limbs in enumerate(groups):
        inside[g, list(member[limbs[0]])] = 1.0
    tight = np.array([1.0 / (cap + 1.5) for _, cap in reading.clauses] + [0.0])
    begun, left, order = np.zeros_like(tight), np.ones(len(groups), dtype=bool), []
    for _ in groups:
        score = inside @ (tight * (begun + 1e-3))
        g = int(np.argmax(np.where(left, score, -1.0)))
        left[g] = False
        begun += inside[g] * len(groups[g])
        order += [(i, g) for i in groups[g]]
    return tuple(order)


@dataclass(eq=False)
class Placer:
    """Places limbs for one number of change times; what is common to all time sets is worked out once."""

    reading: Reading
    kinds: Sequence[int]
    """Per limb, the index of its type in an availability."""
    options: Options
    order: Sequence[tuple[int, int]]
    effort: Effort

    def __post_init__(self) -> None:
        self.counters = counters_for(self.reading, self.options.segments)
        self._spread = [self.counters.spread(mask) for mask in self.options.masks]
        k = self.options.times
        self._flags = [up | down << k for up, down in zip(self.options.lifts, self.options.lands, strict=True)]

    def place(self, available: Sequence[int]) -> list[int] | None:
        """One option per limb within every cap, or None when there is none."""
        choices = [self._choices(i, available[self.kinds[i]]) for i, _ in self.order]
        chosen = [0] * len(self.order)
        if not self._search(choices, chosen):
            return None
        placed = [0] * len(chosen)
        for (i, _), option in zip(self.order, chosen, strict=True):
            placed[i] = option
        return placed

    def _choices(self, limb: int, available: int) -> list[tuple[int, int, int]]:
        """(option, what it adds, lifts and lands): without masks that ask for more swing than another.

        Clauses only ask for stance, so less swing is never worse, but under the gap rule it changes at
        other times.
        """
        gapped, found = self.reading.types[limb].gapped, []
        unit, rest = self.counters.limbs[limb], available
        while rest:
            low = rest & -rest
            option, rest = low.bit_length() - 1, rest ^ low
            if gapped or not self.options.within[option] & available:
                found.append((option, self._spread[option] * unit, self._flags[option] if gapped else 0))
        return found

    def _search(self, choices: Sequence[Sequence[tuple[int, int, int]]], chosen: list[int]) -> bool:
        order, guard, k = self.order, self.counters.guard, self.options.times
        same = [p + 1 < len(order) and order[p + 1][1] == order[p][1] for p in range(len(order))]
        alone = [not same[p] and (p == 0 or not same[p - 1]) for p in range(len(order))]
        failed: set[tuple[int, int, int, int]] = set()
        low_half = (1 << k) - 1

        def place(p: int, first: int, state: int, flags: int) -> bool:
            if p == len(order):
                return True
            key = (p, first, state, flags)
            if key in failed:
                return False
            self.effort.spend()
            size = len(choices[p])
            for index in range(first, size):
                # limbs with clauses of their own take turns, limbs of a class go in the order of their masks
                at = (index + p) % size if alone[p] else index
                option, adds, changes = choices[p][at]
                after, seen = state + adds, flags | changes
                if after & guard or (seen >> k) & seen & low_half:
                    continue
                chosen[p] = option
                if place(p + 1, at if same[p] else 0, after, seen):
                    return True
            failed.add(key)
            return False

        return place(0, 0, self.counters.start, 0)
