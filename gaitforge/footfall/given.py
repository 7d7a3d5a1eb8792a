"""Patterns that need no search: alternating tripod, wave, stand, and what a person wrote down."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from gaitforge.errors import InputError, Problem
from gaitforge.footfall.pattern import FootfallPattern

if TYPE_CHECKING:
    from gaitforge.robot.model import RobotModel


def alternating(limbs: Sequence[str], sides: Sequence[str], columns: int) -> FootfallPattern:
    """The alternating tripod for any number of limbs: L1 R2 L3 R4 … swing in the first half, the rest in the second.

    Limbs are given front to rear on each side; a middle limb goes with the left limb of its rank.
    """
    _least("columns", columns, 2)
    seen: dict[str, int] = {}
    contact = np.ones((len(limbs), columns), dtype=bool)
    half = columns // 2
    for i, side in enumerate(sides):
        rank = seen.get(side, 0)
        seen[side] = rank + 1
        first_group = (rank % 2 == 1) == (side == "right")
        contact[i, :half] = not first_group
        contact[i, half:] = first_group
    return FootfallPattern(contact, tuple(limbs), info={"name": "alternating"})


def wave(
    order: Sequence[str], limbs: Sequence[str], swing_columns: int = 2, stance_columns: int = 1
) -> FootfallPattern:
    """One limb at a time, in `order`, each swing followed by `stance_columns` in which all limbs stand.

    m = n (swing_columns + stance_columns); limbs that are not in `order` swing throughout.
    Source: section III-B.3; the all-stance columns are this project's.
    """
    _least("swing_columns", swing_columns, 1)
    _least("stance_columns", stance_columns, 0)
    _known(order, limbs, "order")
    if len(set(order)) != len(order) or not order:
        raise InputError(Problem("footfall", "order", repr(list(order)), "every walking limb once"))
    step = swing_columns + stance_columns
    contact = np.zeros((len(limbs), step * len(order)), dtype=bool)
    for k, name in enumerate(order):
        row = contact[list(limbs).index(name)]
        row[:] = True
        row[k * step : k * step + swing_columns] = False
    return FootfallPattern(contact, tuple(limbs), source="wave", info={"name": "wave", "order": tuple(order)})


def given(rows: Mapping[str, Sequence[int] | str], cyclic: bool = True) -> FootfallPattern:
    """A hand-written pattern: limb name → "110011…" or a list of 0 and 1; InputError names every bad row."""
    problems = []
    length = max((len(row) for row in rows.values()), default=0)
    for name, row in rows.items():
        if len(row) != length or not {str(c) for c in row} <= {"0", "1"}:
            problems.append(Problem("footfall", f"given.{name}", repr(row), f"{length} times 0 or 1"))
    if not length:
        problems.append(Problem("footfall", "given", repr(dict(rows)), "limb name → 110011…"))
    if problems:
        raise InputError(problems)
    return FootfallPattern.from_rows(rows, cyclic)


def stand_pattern(
    robot: RobotModel,
    columns: int,
    *,
    swing_first: Iterable[str] = (),
    swing_last: Iterable[str] = (),
    free: Iterable[str] = (),
    step_columns: int = 2,
) -> FootfallPattern:
    """All limbs in stance, but `free` ones throughout and some at the ends.

    `swing_first` and `swing_last` swing in the first and last `step_columns`: they are in the air where
    the gait before ends or the gait after begins.
    """
    _least("columns", columns, 1)
    names = robot.limb_names
    contact = np.ones((len(names), columns), dtype=bool)
    ends = slice(0, step_columns), slice(max(0, columns - step_columns), columns)
    for group, where in ((swing_first, ends[0]), (swing_last, ends[1]), (free, slice(None))):
        for name in group:
            contact[names.index(robot.limb(name).name), where] = False
    return FootfallPattern(contact, names, cyclic=False, info={"name": "stand"})


def _least(key: str, value: int, least: int) -> None:
    if value < least:
        raise InputError(Problem("footfall", key, repr(value), f"an integer ≥ {least}"))


def _known(names: Iterable[str], limbs: Sequence[str], key: str) -> None:
    unknown = [n for n in names if n not in limbs]
    if unknown:
        raise InputError([Problem("footfall", key, repr(n), "one of " + ", ".join(limbs)) for n in unknown])
