"""What the solver did, and what the problem consisted of: part of every plan."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Literal


@dataclass(frozen=True)
class TableRow:
    """One family of a problem."""

    family: str
    kind: Literal["constraint", "cost", "bound"]
    rows: int
    """0 for a cost"""
    variables: int
    """How many variables it reads."""
    instances: int
    """How many places it speaks of."""
    active: float | None
    """Share of its rows that lie at a bound; equalities always do.  None for a cost."""
    cost: float | None
    """Value at the solution; None for a constraint."""
    enforced: str
    """Where it holds, and so where it does not."""

    def as_dict(self) -> dict[str, Any]:
        """For ``summary.json``."""
        return asdict(self)


@dataclass(frozen=True)
class SolveReport:
    """What the solver did."""

    status: str = ""
    iterations: int = 0
    seconds: float = 0.0
    """[s] building and solving"""
    cost: float = 0.0
    residual: float = 0.0
    """Largest constraint violation at the solution (SI units)."""
    details: Mapping[str, Any] = field(default_factory=dict)
    table: tuple[TableRow, ...] = ()
    """What the problem consisted of, when asked for."""
