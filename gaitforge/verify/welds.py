"""Grasps that are welded, where a task asks for it: a tip and the object are one body while the robot bears it.

One tip, the stiff one where another squeezes: tips turn on the faces of a box that is drawn in, and two welds
would have the motors fight that.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

from gaitforge.motion.timeline import Timeline


@dataclass(frozen=True)
class Weld:
    """One tip on one object."""

    object: str
    link: str
    """The foot's"""
    start: float
    """[s]"""
    end: float
    """[s]"""


class World(Protocol):
    """What a simulated world has to offer."""

    def fasten(self, weld: Weld) -> Any:
        """Make link and object one body, as they are now; what `release` is told."""
        ...

    def release(self, fastened: Any) -> None:
        """Part them again."""
        ...


def welds_of(timeline: Timeline) -> tuple[Weld, ...]:
    """Every weld of a timeline, one from the lift to the end of the way down; none where friction holds."""
    found: dict[str, list[Weld]] = {}
    for entry in timeline.entries:
        for holding in (h for h in entry.plan.holdings if h.welded):
            limbs = [timeline.robot.limb(name) for name in holding.limbs]
            stiff = [limb for limb in limbs if not set(limb.joints) & set(holding.efforts)]
            same = found.setdefault(holding.object, [])
            if same and abs(same[-1].end - entry.start) < 1e-9:
                same[-1] = replace(same[-1], end=entry.end)
            else:
                same.append(Weld(holding.object, (*stiff, *limbs)[0].foot.link, entry.start, entry.end))
    return tuple(weld for same in found.values() for weld in same)


class Welder:
    """Fastens and releases when it is time."""

    def __init__(self, world: World, welds: Sequence[Weld]) -> None:
        self._world = world
        self._due = sorted(welds, key=lambda weld: weld.start)
        self._fast: list[tuple[float, Any]] = []

    def at(self, time: float) -> None:
        """Before the step from `time` [s]."""
        for end, fastened in [f for f in self._fast if time >= f[0] - 1e-9]:
            self._world.release(fastened)
            self._fast.remove((end, fastened))
        while self._due and time >= self._due[0].start - 1e-9:
            weld = self._due.pop(0)
            self._fast.append((weld.end, self._world.fasten(weld)))
