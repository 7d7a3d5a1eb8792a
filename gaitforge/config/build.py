"""`build`: the one door through which a config becomes objects."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields, is_dataclass
from typing import Any, TypeVar, cast, get_type_hints

from omegaconf import DictConfig, ListConfig, OmegaConf

from gaitforge.config.typecheck import describe, fits
from gaitforge.errors import InputError, Problem

T = TypeVar("T")


def plain(node: Any) -> Any:
    """Nested dicts and lists of a resolved config node."""
    return OmegaConf.to_container(node, resolve=True) if isinstance(node, DictConfig | ListConfig) else node


def build(
    node: Any,
    base: Callable[..., T] | tuple[Callable[..., T], ...],
    *,
    key: str = "",
    file: str = "config",
    allow: Iterable[str] = (),
) -> T:
    """The object that `node` describes by ``_target_`` and its parameters.

    It must be a `base`: a class or a protocol, or one of several.

    Only classes that are defined in gaitforge, or in a package named in `allow` (which comes from the
    command line, never from a file), are made: a dotted path that leads elsewhere is refused, even if
    it starts inside. Nested nodes are built first. Raises `InputError` with file and key.
    """
    packages = ("gaitforge", *allow)
    made = _make(plain(node), key, file, packages)
    bases = base if isinstance(base, tuple) else (base,)
    if not any(_is_a(made, each) for each in bases):
        expected = " or ".join(f"a {getattr(each, '__name__', each)}" for each in bases)
        raise InputError(Problem(file, _join(key, "_target_"), type(made).__name__, expected))
    return cast(T, made)


def _is_a(made: Any, base: Any) -> bool:
    """isinstance; a protocol that cannot be asked is compared by the names of its members."""
    if not getattr(base, "_is_protocol", False):
        return isinstance(made, base)
    return all(hasattr(made, name) for name in vars(base) if not name.startswith("_"))


def _make(value: Any, key: str, file: str, packages: Sequence[str]) -> Any:
    if isinstance(value, Mapping):
        made = {k: _make(v, _join(key, str(k)), file, packages) for k, v in value.items() if k != "_target_"}
        if "_target_" not in value:
            return made
        return _call(_locate(value["_target_"], key, file, packages), made, key, file)
    if isinstance(value, list | tuple):
        return tuple(_make(v, _join(key, str(i)), file, packages) for i, v in enumerate(value))
    return value


def _locate(target: Any, key: str, file: str, packages: Sequence[str]) -> type:
    where = _join(key, "_target_")
    module, _, name = str(target).rpartition(".")
    if not any(module == p or module.startswith(p + ".") for p in packages):
        expected = "a class of " + " or ".join(packages) + " (allow more with --allow-package NAME)"
        raise InputError(Problem(file, where, repr(target), expected))
    try:
        found = getattr(importlib.import_module(module), name)
    except (ImportError, AttributeError) as error:
        raise InputError(Problem(file, where, repr(target), f"a class that exists ({error})")) from error
    home = getattr(found, "__module__", "")
    if not isinstance(found, type) or not any(home == p or home.startswith(p + ".") for p in packages):
        raise InputError(Problem(file, where, repr(target), "a class defined in " + " or ".join(packages)))
    return found


def _call(cls: type, parameters: dict[str, Any], key: str, file: str) -> Any:
    if is_dataclass(cls):
        hints = get_type_hints(cls)
        for name, value in parameters.items():
            if isinstance(value, dict) and is_dataclass(hints.get(name)):
                parameters[name] = _call(hints[name], value, _join(key, name), file)
    problems = _parameter_problems(cls, parameters, key, file)
    if problems:
        raise InputError(problems)
    try:
        return cls(**parameters)
    except (TypeError, ValueError) as error:
        raise InputError(Problem(file, key, str(parameters), str(error))) from error


def _parameter_problems(cls: type, parameters: Mapping[str, Any], key: str, file: str) -> list[Problem]:
    if not is_dataclass(cls):
        return []
    hints = get_type_hints(cls)
    known = {f.name: hints[f.name] for f in fields(cls) if f.init}
    problems = []
    for name, value in parameters.items():
        where = _join(key, name)
        if name not in known:
            problems.append(Problem(file, where, "an unknown key", "one of " + ", ".join(known)))
        elif not fits(value, known[name]):
            problems.append(Problem(file, where, repr(value), describe(known[name])))
    return problems


def _join(key: str, name: str) -> str:
    return f"{key}.{name}" if key else name
