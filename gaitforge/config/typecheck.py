"""Does a value from YAML fit a type hint? Enough of the question to name a wrong parameter before it is used."""

from __future__ import annotations

import types
from typing import Any, Literal, Union, get_args, get_origin


def fits(value: Any, hint: Any) -> bool:
    """True when `value` is of type `hint`; hints that are not understood (classes, mappings, …) fit everything.

    An int is a float, a bool is no number.
    """
    origin, args = get_origin(hint), get_args(hint)
    if origin in (Union, types.UnionType):
        return any(fits(value, a) for a in args)
    if origin is Literal:
        return value in args
    if origin in (tuple, list):
        return _fits_sequence(value, args, origin)
    if hint in (None, type(None)):
        return value is None
    if hint is float:
        return isinstance(value, int | float) and not isinstance(value, bool)
    if hint is int:
        return isinstance(value, int) and not isinstance(value, bool)
    return isinstance(value, hint) if hint in (bool, str) else True


def _fits_sequence(value: Any, args: tuple[Any, ...], origin: Any) -> bool:
    if not isinstance(value, list | tuple):
        return False
    if origin is list or args[-1:] == (Ellipsis,):
        return all(fits(v, args[0]) for v in value) if args else True
    return len(value) == len(args) and all(fits(v, a) for v, a in zip(value, args, strict=True))


def describe(hint: Any) -> str:
    """The hint in words for a message: "a number", "one of 'a', 'b'", …"""
    origin, args = get_origin(hint), get_args(hint)
    if origin in (Union, types.UnionType):
        return " or ".join(describe(a) for a in args)
    if origin is Literal:
        return "one of " + ", ".join(repr(a) for a in args)
    if origin in (tuple, list):
        many = origin is list or args[-1:] == (Ellipsis,)
        return f"a list of {describe(args[0])}" if many else f"a list of {len(args)} values"
    names = {float: "a number", int: "a whole number", bool: "true or false", str: "a text", type(None): "null"}
    return names.get(hint, getattr(hint, "__name__", str(hint)))
