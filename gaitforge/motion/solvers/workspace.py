"""What a solve of a known structure does not have to make again: structure, buffers, ordering."""

from __future__ import annotations

import threading
from dataclasses import dataclass, field

from gaitforge.motion.problem import Problem
from gaitforge.motion.solvers.evaluation import Evaluation
from gaitforge.motion.solvers.factor import Factor, factor_of
from gaitforge.motion.solvers.structure import Structure, analyse, structure_key

KEPT = 32
"""Structures that a thread remembers."""


@dataclass(frozen=True, eq=False)
class Workspace:
    """Buffers for one structure, overwritten by every solve."""

    structure: Structure
    native: bool
    """Compiled code where there is a compiler"""
    evaluation: Evaluation = field(init=False)
    factor: Factor = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "evaluation", Evaluation(self.structure, self.native))
        object.__setattr__(self, "factor", factor_of(*self.structure.pattern, self.native))


class _Memory(threading.local):
    """Buffers are written to, so every thread has its own."""

    def __init__(self) -> None:
        self.workspaces: dict[tuple[bytes, bool], Workspace] = {}


_memory = _Memory()


def workspace_of(problem: Problem, native: bool = True) -> Workspace:
    """The workspace for a problem's structure, from memory when one like it was solved before."""
    known, key = _memory.workspaces, (structure_key(problem), native)
    found = known.pop(key, None) or Workspace(analyse(problem), native)
    known[key] = found  # newest last
    while len(known) > KEPT:
        del known[next(iter(known))]
    return found


def forget() -> None:
    """Drop what this thread remembers (for measuring cold starts)."""
    _memory.workspaces.clear()
