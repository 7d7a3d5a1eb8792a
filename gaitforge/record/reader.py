"""`read_run`: a log back as values, so that it can be replayed, checked and executed again."""

from __future__ import annotations

import json
import os
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from gaitforge.errors import InputError, Problem
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion.plan import Array
from gaitforge.motion.timeline import Timeline
from gaitforge.record.archive import digest, read_archive
from gaitforge.record.rebuild import timeline_from_arrays
from gaitforge.record.values import loads
from gaitforge.robot.model import RobotModel
from gaitforge.task.scene import Scene


@dataclass(frozen=True, eq=False)
class Segment:
    """One entry of the timeline as the log has it."""

    name: str
    kind: str
    cycles: int
    start: float
    """[s]"""
    pattern: FootfallPattern
    """C, exactly"""
    joint_positions: Array
    """P, exactly: (n_J, r·m + 1) [rad]"""


@dataclass(frozen=True, eq=False)
class RunLog:
    """Everything a log holds."""

    path: Path
    robot: RobotModel
    scene: Scene
    timeline: Timeline
    """Ready to be executed again."""
    segments: tuple[Segment, ...]
    report: Mapping[str, Any]
    """verdict, simulator and checks as `/verify/report` has them"""
    topics: Mapping[str, int]
    """Topic → number of messages"""
    metadata: Mapping[str, str]
    attachments: Mapping[str, bytes] = field(repr=False)
    start_time_ns: int = 0
    """Stamp of t = 0 [ns]"""

    @property
    def urdf(self) -> str:
        """The robot as it was simulated."""
        return self.attachments["robot.urdf"].decode()

    def messages(self, topic: str) -> Iterator[tuple[float, Any]]:
        """(time [s], decoded message) of a topic: a protobuf message or a dict."""
        for _, stamp, message in _decoded(self.path, topic):
            yield (stamp - self.start_time_ns) * 1e-9, message


def read_run(path: str | os.PathLike[str]) -> RunLog:
    """Read a log that `write_log` wrote: every message is decoded, every CRC and fingerprint checked.

    Raises
    ------
    InputError
        When the file is no such log, is cut short, or does not hold what its fingerprints promise.
    """
    file = Path(path)
    try:
        return _read(file)
    except InputError:
        raise
    except FileNotFoundError as error:
        raise InputError(Problem(str(file), "", "no such file", "an MCAP log of gaitforge")) from error
    except Exception as error:  # the mcap reader raises bare Exceptions, struct.error, DecodeError, …
        found = f"a file that cannot be read ({type(error).__name__}: {error})"
        raise InputError(Problem(str(file), "", found, "an MCAP log of gaitforge")) from error


def _read(file: Path) -> RunLog:
    topics: Counter[str] = Counter()
    kept: dict[str, list[tuple[int, Any]]] = {"/plan/segment": [], "/verify/report": []}
    for topic, stamp, message in _decoded(file):
        topics[topic] += 1
        if topic in kept:
            kept[topic].append((stamp, message))
    metadata, attachments = _records(file)
    arrays = read_archive(attachments["plan.npz"])
    robot = loads(attachments["robot.json"])
    timeline = timeline_from_arrays(robot, arrays)
    names = [str(name) for name in arrays["timeline/segment"]]
    _check_fingerprints(file, [message for _, message in kept["/plan/segment"]], arrays)
    ((start, report),) = kept["/verify/report"]
    segments = tuple(
        Segment(name, e.plan.kind, e.cycles, e.start, e.plan.pattern, e.plan.joint_positions)
        for name, e in zip(names, timeline.entries, strict=True)
    )
    scene = loads(attachments["scene.json"])
    return RunLog(
        file, robot, scene, timeline, segments, report, dict(topics), metadata, attachments, start_time_ns=start
    )


def _decoded(file: Path, topic: str | None = None) -> Iterator[tuple[str, int, Any]]:
    """(topic, log time [ns], decoded message) of every message, or of one topic's."""
    from mcap.reader import make_reader
    from mcap_protobuf.decoder import DecoderFactory

    factories: list[Any] = [DecoderFactory(), _StrictJson()]
    with file.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=factories)
        for _, channel, message, decoded in reader.iter_decoded_messages(topics=[topic] if topic else None):
            yield channel.topic, message.log_time, decoded


class _StrictJson:
    """A decoder factory of mcap for JSON messages; NaN and Infinity are no JSON."""

    def decoder_for(self, message_encoding: str, schema: Any) -> Callable[[bytes], Any] | None:
        return _strict_json if message_encoding == "json" else None


def _strict_json(data: bytes) -> Any:
    def refuse(constant: str) -> None:
        raise ValueError(f"{constant} in a JSON message")

    return json.loads(data, parse_constant=refuse)


def _records(file: Path) -> tuple[dict[str, str], dict[str, bytes]]:
    from mcap.reader import make_reader

    with file.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        metadata = {record.name: dict(record.metadata) for record in reader.iter_metadata()}
        attachments = {record.name: record.data for record in reader.iter_attachments()}
    return metadata["gaitforge"], attachments


def _check_fingerprints(file: Path, messages: list[dict[str, Any]], arrays: Mapping[str, Any]) -> None:
    wrong = [
        Problem(
            str(file), f"/plan/segment {message['name']}", f"another {what}", f"SHA-256 {message[f'sha256_{what}']}"
        )
        for message in messages
        for what in ("C", "P")
        if digest(arrays[f"{message['name']}/{what}"]) != message[f"sha256_{what}"]
    ]
    if wrong:
        raise InputError(wrong)
