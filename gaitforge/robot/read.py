"""Reading a user's YAML: every value checked, all problems of a file collected and raised together."""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import yaml

from gaitforge.errors import InputError, Problem

FORMAT = 1
"""Version of the module and assembly formats that this gaitforge reads."""


class _Loader(yaml.SafeLoader):  # type: ignore[misc]
    """YAML as people expect it: 1e-4 is a number, only true/false are booleans, a repeated key is an error."""


_Loader.yaml_implicit_resolvers = {
    first: [(tag, pattern) for tag, pattern in resolvers if tag != "tag:yaml.org,2002:bool"]
    for first, resolvers in yaml.SafeLoader.yaml_implicit_resolvers.items()
}
_Loader.add_implicit_resolver("tag:yaml.org,2002:bool", re.compile("^(?:true|false)$"), list("tf"))
_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float", re.compile(r"^[-+]?(\d+\.?\d*|\.\d+)[eE][-+]?\d+$"), list("-+.0123456789")
)


def _mapping(loader: _Loader, node: yaml.MappingNode) -> dict[Any, Any]:
    seen: set[Any] = set()
    for key_node, _ in node.value:
        key = loader.construct_object(key_node, deep=True)
        if not isinstance(key, str | int | float):
            raise yaml.constructor.ConstructorError(None, None, "a key is not a plain word", key_node.start_mark)
        if key in seen:
            raise yaml.constructor.ConstructorError(None, None, f"the key {key!r} twice", key_node.start_mark)
        seen.add(key)
    return dict(loader.construct_mapping(node, deep=True))


_Loader.add_constructor("tag:yaml.org,2002:map", _mapping)


def load_yaml(path: Path) -> dict[str, Any]:
    """The mapping in a YAML file; InputError when it cannot be read, is not YAML or not a mapping."""
    try:
        data = yaml.load(path.read_text(encoding="utf-8"), Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        where = f"line {error.problem_mark.line + 1}" if error.problem_mark else ""
        raise InputError(Problem(str(path), where, error.problem or "no YAML", "YAML, each key once")) from error
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise InputError(Problem(str(path), "", str(error), "a readable YAML file")) from error
    if not isinstance(data, dict):
        raise InputError(Problem(str(path), "", type(data).__name__, "a mapping of keys to values"))
    return {str(key): value for key, value in data.items()}


class Section:
    """One mapping of a file, its place in it, and the list that problems of the file are collected in.

    A number may be written as the name of a parameter, or as ``{base: 0.199, length: 0.4}``
    (0.199 + 0.4 · length); `values` holds the parameters.
    """

    def __init__(
        self,
        data: Any,
        file: str,
        key: str = "",
        problems: list[Problem] | None = None,
        values: Mapping[str, float] | None = None,
    ) -> None:
        self.file, self.key = file, key
        self.problems = problems if problems is not None else []
        self.values = dict(values or {})
        if data is not None and not isinstance(data, Mapping):
            self.problem("", repr(data), "a mapping of keys to values")
        self.data: dict[str, Any] = {str(k): v for k, v in data.items()} if isinstance(data, Mapping) else {}

    def at(self, key: str) -> str:
        """The full key path of a key of this section."""
        return ".".join(x for x in (self.key, key) if x)

    def problem(self, key: str, found: str, expected: str) -> None:
        """Note one thing that is wrong."""
        self.problems.append(Problem(self.file, self.at(key), found, expected))

    def raise_problems(self) -> None:
        """InputError with everything collected so far, if there is anything."""
        if self.problems:
            raise InputError(self.problems)

    def only(self, *allowed: str) -> None:
        """Unknown keys are problems; a near miss is named."""
        for key in self.data:
            if key not in allowed:
                near = difflib.get_close_matches(key, allowed, 1)
                hint = f"did you mean {near[0]!r}? " if near else ""
                self.problem(key, f"the unknown key {key!r}", hint + "one of " + ", ".join(allowed))

    def __contains__(self, key: str) -> bool:
        return key in self.data

    def child(self, key: str, data: Any = None, name: str | None = None) -> Section:
        """The section below `key` (or `data`, which stands at `key`)."""
        found = self.data.get(key) if data is None else data
        return Section(found, self.file, self.at(name or key), self.problems, self.values)

    def children(self, key: str) -> dict[str, Section]:
        """Name → section for a mapping of mappings."""
        inner = self.child(key)
        return {name: inner.child(name, {} if value is None else value) for name, value in inner.data.items()}

    def listed(self, key: str) -> list[Section]:
        """Sections of a list of mappings."""
        items = self.data.get(key, [])
        if not isinstance(items, list):
            self.problem(key, repr(items), "a list")
            return []
        return [self.child(key, {} if x is None else x, f"{key}[{i}]") for i, x in enumerate(items)]

    # -- values ---------------------------------------------------------------------------
    def text(self, key: str, choices: Iterable[str] | None = None, default: str | None = None) -> str:
        """A word; one of `choices` if given."""
        value = self.data.get(key, default)
        options = None if choices is None else tuple(choices)
        if not isinstance(value, str) or (options is not None and value not in options):
            found = "nothing" if value is None else repr(value)
            self.problem(key, found, "a text" if options is None else "one of " + ", ".join(options))
            return default or ""
        return value

    def flag(self, key: str, default: bool) -> bool:
        """true or false."""
        value = self.data.get(key, default)
        if not isinstance(value, bool):
            self.problem(key, repr(value), "true or false")
        return bool(value)

    def number(
        self,
        key: str,
        unit: str = "",
        default: float | None = None,
        above: float | None = None,
        least: float | None = None,
    ) -> float:
        """A finite number [unit], > `above`, ≥ `least`; without a default it must be there."""
        if key not in self.data and default is not None:
            return default
        value = self._quantity(self.data.get(key))
        bound = f" > {above:g}" if above is not None else f" ≥ {least:g}" if least is not None else ""
        fits = value is not None and (above is None or value > above) and (least is None or value >= least)
        if value is None or not fits:
            raw = self.data.get(key)
            found = "nothing" if raw is None else repr(raw) if value is None else f"{value:g}"
            self.problem(key, found, f"a number{bound}{f' [{unit}]' if unit else ''}")
            return 1.0
        return value

    def integer(self, key: str, default: int, least: int = 1) -> int:
        """A whole number ≥ `least`."""
        value = self.data.get(key, default)
        if isinstance(value, bool) or not isinstance(value, int) or value < least:
            self.problem(key, repr(value), f"a whole number ≥ {least}")
            return default
        return value

    def vector(self, key: str, n: int, unit: str, default: tuple[float, ...] | None = None) -> tuple[float, ...]:
        """A list of n numbers [unit]."""
        raw = self.data.get(key)
        if raw is None and default is not None:
            return default
        values = [self._quantity(x) for x in raw] if isinstance(raw, list) else []
        if len(values) != n or any(v is None for v in values):
            self.problem(key, "nothing" if raw is None else repr(raw), f"a list of {n} numbers [{unit}]")
            return tuple([0.0] * n)
        return tuple(v for v in values if v is not None)

    def _quantity(self, raw: Any) -> float | None:
        if isinstance(raw, str):
            return self.values.get(raw)
        if isinstance(raw, Mapping):
            terms = [(self._quantity(f), 1.0 if k == "base" else self.values.get(k)) for k, f in raw.items()]
            factors = [(f, v) for f, v in terms if f is not None and v is not None]
            return sum(f * v for f, v in factors) if len(factors) == len(terms) else None
        if isinstance(raw, bool) or not isinstance(raw, int | float) or not math.isfinite(raw):
            return None
        return float(raw)


def check_format(top: Section) -> None:
    """`format: 1` must be there; a file of a later format is refused, not guessed at."""
    found = top.data.get("format")
    if found != FORMAT or isinstance(found, bool):
        top.problem("format", "nothing" if found is None else repr(found), f"format: {FORMAT}")
