"""What has to hold of the rows of an experiment, as data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

KEYS = ("where", "at_least", "at_most", "equal")


@dataclass(frozen=True)
class Rule:
    """``{where: {method: optimise}, at_least: {speed_share: 0.95}, equal: {fallen: false}}``, say.

    A rule speaks of the rows whose values are those of `where` (a list: any of them).
    """

    where: Mapping[str, Any] = field(default_factory=dict)
    at_least: Mapping[str, float] = field(default_factory=dict)
    at_most: Mapping[str, float] = field(default_factory=dict)
    equal: Mapping[str, Any] = field(default_factory=dict)

    @staticmethod
    def read(data: Any, key: str) -> Rule:
        """The rule that a mapping describes; ValueError for keys that it cannot have."""
        if not isinstance(data, Mapping) or not all(isinstance(v, Mapping) for v in data.values()):
            raise ValueError(f"{key}: found {data!r}, expected a mapping of mappings {', '.join(KEYS)}")
        unknown = [name for name in data if name not in KEYS]
        if unknown:
            raise ValueError(f"{key}: found {', '.join(unknown)}, expected {', '.join(KEYS)}")
        return Rule(**data)

    def concerns(self, row: Mapping[str, Any]) -> bool:
        """Does the rule speak of this row?"""
        return all(_among(row.get(key), value) for key, value in self.where.items())

    def broken(self, row: Mapping[str, Any]) -> list[str]:
        """What the row does not keep, in words; a value that is missing keeps nothing."""
        said = []
        for key, least in self.at_least.items():
            if row.get(key) is None or row[key] < least:
                said.append(f"{key} {_number(row.get(key))} < {least:g}")
        for key, most in self.at_most.items():
            if row.get(key) is None or row[key] > most:
                said.append(f"{key} {_number(row.get(key))} > {most:g}")
        for key, value in self.equal.items():
            if not _among(row.get(key), value):
                said.append(f"{key} is {row.get(key)!r}, not {value!r}")
        return said


def accepted(row: Mapping[str, Any], rules: Sequence[Rule]) -> tuple[bool | None, list[str]]:
    """(do all rules hold that speak of this row; None when none does, what is broken)."""
    concerned = [rule for rule in rules if rule.concerns(row)]
    if not concerned:
        return None, []
    broken = [text for rule in concerned for text in rule.broken(row)]
    return not broken, broken


def _among(value: Any, wanted: Any) -> bool:
    return value in wanted if isinstance(wanted, list | tuple) else bool(value == wanted)


def _number(value: Any) -> str:
    return "unknown" if value is None else f"{value:.4g}"
