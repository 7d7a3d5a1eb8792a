"""One root, few branches; every error carries the data that a person needs to mend it.

The command line maps the branches to exit codes (``exit_code``): 2 bad input, 3 infeasible,
4 internal, 5 unsolved.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from typing import Any


class GaitforgeError(Exception):
    """Root of all errors that gaitforge raises on purpose."""

    exit_code: int = 4
    status: str = "error"

    def as_dict(self) -> dict[str, Any]:
        """The ``error`` entry of ``summary.json``: type, file, key, found, expected."""
        return {"type": type(self).__name__, "file": None, "key": None, "found": str(self), "expected": None}


@dataclass(frozen=True)
class Problem:
    """One thing wrong in a user's input: where (file, key), what was found, what was expected."""

    file: str
    key: str
    found: str
    expected: str

    def __str__(self) -> str:
        where = f"{self.file}: {self.key}" if self.key else self.file
        return f"{where}: found {self.found}; expected {self.expected}"


class InputError(GaitforgeError):
    """Bad input: one or more `Problem`s, all problems of a file reported together (exit code 2)."""

    exit_code = 2

    def __init__(self, problems: Problem | Iterable[Problem]) -> None:
        self.problems: tuple[Problem, ...] = (problems,) if isinstance(problems, Problem) else tuple(problems)
        super().__init__("\n".join(str(p) for p in self.problems))

    def as_dict(self) -> dict[str, Any]:
        return {"type": type(self).__name__, **asdict(self.problems[0])}

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.problems,)


class Explained(GaitforgeError):
    """An answer that is no plan, with what is known about why: `explain` goes into ``summary.json``."""

    def __init__(self, message: str, explain: Mapping[str, Any] | None = None) -> None:
        self.message = message
        self.explain: dict[str, Any] = dict(explain or {})
        super().__init__(message)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.message, self.explain)


class InfeasibleError(Explained):
    """There is no solution, and `explain` holds the proof (exit code 3)."""

    exit_code = 3
    status = "infeasible"


class InfeasibleFootfall(InfeasibleError):
    """No contact pattern satisfies the constraint sets; `explain["families"]` clash."""


class InfeasibleMotion(InfeasibleError):
    """No motion plan exists for the pattern, by a static or geometric certificate."""


class UnsolvedError(Explained):
    """A search ended with nothing and without a proof that there is nothing (exit code 5)."""

    exit_code = 5
    status = "unsolved"


class SimulationError(GaitforgeError):
    """The simulator refused the robot or stopped answering (exit code 4)."""
