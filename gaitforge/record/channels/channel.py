"""A channel: a topic, what its messages look like, and the messages themselves."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from gaitforge.record.run import Run

Messages = list[tuple[int, bytes]]
"""(log time [ns], serialized message), in time order"""


@dataclass(frozen=True)
class Schema:
    """How a channel's messages are to be decoded."""

    name: str
    encoding: str
    """protobuf · jsonschema"""
    data: bytes = field(repr=False)


@dataclass(frozen=True)
class Channel:
    """A topic of the log."""

    topic: str
    schema: Schema
    messages: Messages = field(repr=False)

    @property
    def message_encoding(self) -> str:
        """protobuf · json"""
        return "protobuf" if self.schema.encoding == "protobuf" else "json"


def protobuf_channel(topic: str, message_class: Any, messages: Iterable[tuple[int, Any]]) -> Channel:
    """A channel of protobuf messages; all are of `message_class`."""
    from mcap_protobuf.schema import build_file_descriptor_set

    data = build_file_descriptor_set(message_class).SerializeToString(deterministic=True)
    schema = Schema(message_class.DESCRIPTOR.full_name, "protobuf", data)
    return Channel(topic, schema, [(t, m if isinstance(m, bytes) else m.SerializeToString()) for t, m in messages])


def json_channel(
    topic: str, name: str, properties: Mapping[str, Any], messages: Iterable[tuple[int, Mapping[str, Any]]]
) -> Channel:
    """A channel of JSON messages: objects with these properties (JSON schema, one type string each).

    Numbers are rounded to six digits after the point; a NaN raises ValueError, because one NaN makes
    a viewer drop the whole message.
    """
    schema = {"title": name, "type": "object", "properties": dict(properties)}
    written = [(t, _compact(_rounded(message)).encode()) for t, message in messages]
    return Channel(topic, Schema(name, "jsonschema", _compact(schema).encode()), written)


def number(description: str) -> dict[str, str]:
    """JSON schema of a number."""
    return {"type": "number", "description": description}


def text(description: str) -> dict[str, str]:
    """JSON schema of a text."""
    return {"type": "string", "description": description}


def boolean(description: str) -> dict[str, str]:
    """JSON schema of a truth value."""
    return {"type": "boolean", "description": description}


def array(items: Mapping[str, Any], description: str) -> dict[str, Any]:
    """JSON schema of a list."""
    return {"type": "array", "items": dict(items), "description": description}


def objects(properties: Mapping[str, Any], description: str) -> dict[str, Any]:
    """JSON schema of a list of objects."""
    return array({"type": "object", "properties": dict(properties)}, description)


def set_stamp(timestamp: Any, run: Run, time: float) -> int:
    """Write the log time of simulated time `time` [s] into a protobuf Timestamp; gives it back [ns]."""
    stamp = run.stamp(time)
    timestamp.seconds, timestamp.nanos = divmod(stamp, 1_000_000_000)
    return stamp


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return round(value, 6)
    if isinstance(value, Mapping):
        return {key: _rounded(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_rounded(item) for item in value]
    return value


def _compact(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
