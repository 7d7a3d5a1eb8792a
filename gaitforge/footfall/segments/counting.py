"""How many patterns share their change times, and which is the i-th of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from gaitforge.footfall.segments.placing import Counters, Effort

Choice = tuple[int, int, int]
"""Option, what it adds to the counters, what it does to the flags."""


@dataclass(frozen=True)
class Flags:
    """What has happened so far, as bits: times used, shortest swing met, lifts and lands under the gap rule."""

    times: int
    shortest: bool
    """Whether some limb has to swing for exactly the shortest time, so that no pattern is counted twice."""
    gapped: bool
    """Whether the gap rule is in force for any limb."""

    @property
    def needed(self) -> int:
        """The flags of a whole pattern: every time used, and the shortest swing met."""
        return (1 << (self.times + self.shortest)) - 1

    def of(self, lifts: int, lands: int, shortest: bool, gapped: bool) -> int:
        """The flags that one limb sets."""
        k = self.times
        found = lifts | lands | (int(shortest and self.shortest) << k)
        return found | (lifts << (k + 1) | lands << (2 * k + 1)) * gapped

    def clash(self, flags: int) -> int:
        """Not 0 when a limb lifts while another lands."""
        k = self.times
        return (flags >> (k + 1)) & (flags >> (2 * k + 1)) & ((1 << k) - 1)


@dataclass(eq=False)
class Completions:
    """Counts, by dynamic programming over limbs, the ways to place all limbs within every cap."""

    choices: Sequence[Sequence[Choice]]
    """Per limb in the order of placing."""
    counters: Counters
    flags: Flags
    effort: Effort
    _known: dict[tuple[int, int, int], int] = field(default_factory=dict)

    def total(self) -> int:
        """Number of patterns; raises TooHard when the effort is used up."""
        return self._count(0, self.counters.start, 0)

    def at(self, index: int) -> list[int]:
        """The options of the pattern with this number, 0 ≤ index < total, per limb in the order of placing."""
        state, flags, found, gapped = self.counters.start, 0, [], self.flags.gapped
        for p, choices in enumerate(self.choices):
            for option, adds, sets in choices:
                after, seen = state + adds, flags | sets
                if after & self.counters.guard or (gapped and self.flags.clash(seen)):
                    continue
                here = self._count(p + 1, after, seen)
                if index < here:
                    found.append(option)
                    state, flags = after, seen
                    break
                index -= here
        return found

    def _count(self, p: int, state: int, flags: int) -> int:
        if p == len(self.choices):
            return int(flags & self.flags.needed == self.flags.needed)
        key = (p, state, flags)
        known = self._known.get(key)
        if known is not None:
            return known
        self.effort.spend()
        total, guard, gapped = 0, self.counters.guard, self.flags.gapped
        for _, adds, sets in self.choices[p]:
            after, seen = state + adds, flags | sets
            if not (after & guard or (gapped and self.flags.clash(seen))):
                total += self._count(p + 1, after, seen)
        self._known[key] = total
        return total
