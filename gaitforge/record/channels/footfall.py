"""`/footfall/plan`, `/footfall/sim`, `/footfall/compare`: the pattern, what happened, and the difference."""

from __future__ import annotations

import re
from enum import IntEnum
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitforge.record.channels.channel import Channel, boolean, json_channel, number, protobuf_channel
from gaitforge.record.columns import Columns, columns_of
from gaitforge.record.run import Run

Bools = NDArray[np.bool_]


class Agreement(IntEnum):
    """A foot's contact against its plan."""

    air = 0
    """In the air, as planned."""
    stance = 1
    """On the ground, as planned."""
    early = 2
    """It landed or lifted before its time."""
    late = 3
    """It has yet to land or lift."""


def footfall_channels(run: Run) -> list[Channel]:
    """Booleans and enums: State Transitions draws other values in colours that mean nothing."""
    columns = columns_of(run.timeline)
    fields = {name: boolean("in stance") for name in map(field_name, run.robot.limb_names)}
    fields["column"] = number("column of the segment's pattern")
    happened = [(k, row) for k, row in enumerate(column_contact(run, columns)) if row is not None]
    plan = [(k, row) for k, row in enumerate(columns.contact)]
    return [
        json_channel("/footfall/plan", "gaitforge.Footfall", fields, _columns(run, columns, plan)),
        json_channel("/footfall/sim", "gaitforge.Footfall", fields, _columns(run, columns, happened)),
        _compare(run),
    ]


def field_name(limb: str) -> str:
    """The limb's name as a message field: letters, digits and underscores."""
    name = re.sub(r"\W", "_", limb, flags=re.ASCII)
    return f"_{name}" if name[:1].isdigit() else name


def column_contact(run: Run, columns: Columns) -> list[Bools | None]:
    """(n_F,) per column: was the foot on the ground for at least half of it; None where nothing was recorded."""
    bounds = np.searchsorted(run.trace.times, columns.times - 1e-9)
    return [run.contact[a:b].mean(axis=0) >= 0.5 if b > a else None for a, b in pairwise(bounds)]


def agreement(planned: Bools, actual: Bools, times: NDArray[np.float64]) -> NDArray[np.intp]:
    """(n, n_F) `Agreement` of contacts at n times [s].

    Where the two differ, the nearest planned change of that foot decides: the change before it is
    late (has not come yet), the change after it came early.  A foot that never changes is early
    when it touches the ground and late when it does not.
    """
    found = np.where(planned, Agreement.stance, Agreement.air).astype(np.intp)
    for foot in range(planned.shape[1]):
        changes = times[1:][planned[1:, foot] != planned[:-1, foot]]
        wrong = np.flatnonzero(planned[:, foot] != actual[:, foot])
        if not len(changes):
            found[wrong, foot] = np.where(actual[wrong, foot], Agreement.early, Agreement.late)
            continue
        after = np.searchsorted(changes, times[wrong], side="right")
        since = np.where(after > 0, times[wrong] - changes[np.maximum(after - 1, 0)], np.inf)
        until = np.where(after < len(changes), changes[np.minimum(after, len(changes) - 1)] - times[wrong], np.inf)
        found[wrong, foot] = np.where(since <= until, Agreement.late, Agreement.early)
    return found


def _columns(run: Run, columns: Columns, rows: list[tuple[int, Bools]]) -> list[tuple[int, dict[str, Any]]]:
    names = [field_name(name) for name in run.robot.limb_names]
    messages = []
    for k, row in rows:
        message: dict[str, Any] = {name: bool(c) for name, c in zip(names, row, strict=True)}
        message["column"] = int(columns.column[k])
        messages.append((run.stamp(columns.times[k]), message))
    return messages


def _compare(run: Run) -> Channel:
    names = tuple(field_name(name) for name in run.robot.limb_names)
    message_class = compare_class(names)
    states = agreement(run.trace.plan.contact, run.contact, run.trace.times)
    changed = np.flatnonzero(np.any(states[1:] != states[:-1], axis=1)) + 1
    messages = []
    for row in dict.fromkeys((0, *changed.tolist(), len(states) - 1)):
        fields = {name: int(state) for name, state in zip(names, states[row], strict=True)}
        messages.append((run.stamp(run.trace.times[row]), message_class(**fields)))
    return protobuf_channel("/footfall/compare", message_class, messages)


@cache
def compare_class(fields: tuple[str, ...]) -> Any:
    """A protobuf message with one `Agreement` per limb.

    Protobuf, because its enums are the only ones that Lichtblick shows by name; it reads a JSON
    integer as a plain number.
    """
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

    file = descriptor_pb2.FileDescriptorProto(
        name="gaitforge/FootfallCompare.proto", package="gaitforge", syntax="proto3"
    )
    message = file.message_type.add(name="FootfallCompare")
    enum = message.enum_type.add(name="Agreement")
    for state in Agreement:
        enum.value.add(name=state.name, number=state.value)
    kind = descriptor_pb2.FieldDescriptorProto
    for k, name in enumerate(fields):
        message.field.add(
            name=name,
            number=k + 1,
            type=kind.TYPE_ENUM,
            label=kind.LABEL_OPTIONAL,
            type_name=".gaitforge.FootfallCompare.Agreement",
        )
    pool = descriptor_pool.DescriptorPool()
    pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName("gaitforge.FootfallCompare"))
