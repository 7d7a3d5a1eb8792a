"""Reading plain data: each question notes a problem instead of raising, so that all are reported together."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from gaitforge.errors import Problem


class Reader:
    """Collects the problems of one file; every method returns a usable value even when the input is wrong."""

    def __init__(self, file: str) -> None:
        self.file = file
        self.problems: list[Problem] = []

    def problem(self, key: str, found: str, expected: str) -> None:
        """Note one problem."""
        self.problems.append(Problem(self.file, key, found, expected))

    def mapping(self, value: Any, key: str, allowed: Sequence[str] | None = None) -> Mapping[str, Any]:
        """A mapping (None = empty) with no keys but the allowed ones."""
        if value is None:
            return {}
        if not isinstance(value, Mapping):
            self.problem(key, repr(value), "a mapping")
            return {}
        for name in value if allowed is not None else ():
            if name not in (allowed or ()):
                here = f"{key}.{name}" if key else str(name)
                expected = "one of " + ", ".join(allowed or ()) if allowed else "no such key here"
                self.problem(here, "an unknown key", expected)
        return {str(k): v for k, v in value.items() if allowed is None or k in allowed}

    def listing(self, value: Any, key: str) -> list[Any]:
        """A list (None = empty)."""
        if value is None:
            return []
        if not isinstance(value, list | tuple):
            self.problem(key, repr(value), "a list")
            return []
        return list(value)

    def text(self, value: Any, key: str) -> str:
        """A name that can stand in file and topic names."""
        if not isinstance(value, str) or not value or not value.replace("_", "").replace("-", "").isalnum():
            self.problem(key, repr(value), "a name of letters, digits, _ and -")
            return ""
        return value

    def choice(self, value: Any, key: str, choices: Sequence[str]) -> Any:
        """One of the given texts."""
        if not isinstance(value, str) or value not in choices:
            self.problem(key, repr(value), "one of " + ", ".join(choices))
            return choices[0]
        return value

    def number(self, value: Any, key: str, expected: str, good: Callable[[float], bool]) -> float:
        """A finite number that is `good`."""
        if isinstance(value, bool) or not isinstance(value, int | float):
            self.problem(key, repr(value), expected)
            return 0.0
        if not math.isfinite(value) or not good(value):
            self.problem(key, repr(value), expected)
        return float(value)

    def count(self, value: Any, key: str, expected: str) -> int:
        """A whole number ≥ 1."""
        if isinstance(value, bool) or not isinstance(value, int) or value < 1:
            self.problem(key, repr(value), expected)
            return 1
        return value

    def numbers(self, value: Any, key: str, expected: str) -> tuple[float, ...]:
        """A list of finite numbers."""
        if not isinstance(value, list | tuple):
            self.problem(key, repr(value), expected)
            return ()
        return tuple(self.number(v, f"{key}.{i}", expected, math.isfinite) for i, v in enumerate(value))

    def vector(self, value: Any, key: str, expected: str) -> tuple[float, float, float]:
        """Three finite numbers."""
        values = self.numbers(value, key, expected)
        if len(values) != 3:
            if values or isinstance(value, list | tuple):
                self.problem(key, f"{len(values)} values", expected)
            return 0.0, 0.0, 0.0
        return values[0], values[1], values[2]

    def unique(self, names: Sequence[str], key: str, expected: str) -> None:
        """Every name once."""
        for name in dict.fromkeys(n for n in names if names.count(n) > 1):
            self.problem(key, f"{name!r} twice", expected)
