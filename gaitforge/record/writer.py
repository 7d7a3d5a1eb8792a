"""`write_log`: a verified run as one MCAP file from which it can be replayed, checked and executed."""

from __future__ import annotations

import os
import time
from collections.abc import Mapping
from typing import IO, Any, Literal

from gaitforge import __version__
from gaitforge.record.archive import archive_bytes
from gaitforge.record.channels import channels
from gaitforge.record.channels.channel import Channel
from gaitforge.record.channels.events import status
from gaitforge.record.files import replacing
from gaitforge.record.run import Run
from gaitforge.record.values import dumps
from gaitforge.robot.model import RobotModel
from gaitforge.task.scene import Scene
from gaitforge.verify.verdict import Verdict

Compression = Literal["zstd", "none"]
CHUNK_BYTES = 1024 * 1024
MEDIA_TYPES = {
    ".urdf": "application/xml",
    ".json": "application/json",
    ".npz": "application/zip",
    ".yaml": "application/yaml",
    ".png": "image/png",
    ".html": "text/html",
    ".csv": "text/csv",
}


def write_log(
    path: str | os.PathLike[str],
    robot: RobotModel,
    verdict: Verdict,
    *,
    scene: Scene | None = None,
    metadata: Mapping[str, str] | None = None,
    attachments: Mapping[str, bytes] | None = None,
    start_time_ns: int | None = None,
    rate_hz: float = 50.0,
    scene_hz: float = 25.0,
    compression: Compression = "zstd",
) -> None:
    """Write the run to `path` (MCAP), atomically; docs/logs.md lists topics and attachments.

    Parameters
    ----------
    verdict
        Carries the trace and the timeline.
    metadata
        More entries for the metadata record ``gaitforge`` (config hash, seed, …).
    attachments
        More files (name → bytes) beside robot.urdf, robot.json, scene.json and plan.npz.
    start_time_ns
        What t = 0 is stamped with [ns since 1970]; now by default.  With a fixed value equal runs
        give equal bytes.
    rate_hz, scene_hz
        States and drawings per second of simulated time.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    start = time.time_ns() if start_time_ns is None else start_time_ns
    run = Run(robot, verdict, scene or Scene(), start, rate_hz, scene_hz)
    files = {
        "robot.urdf": robot.urdf.encode(),
        "robot.json": dumps(robot).encode(),
        "scene.json": dumps(run.scene).encode(),
        "plan.npz": archive_bytes(verdict.timeline),
        **(attachments or {}),
    }
    record = {
        "version": __version__,
        "robot": robot.name,
        "simulator": " and ".join(verdict.simulators),
        "verdict": status(run),
    }
    found = channels(run)
    with replacing(path) as stream:
        _write(stream, found, record | dict(metadata or {}), files, start, compression)


def _write(
    stream: IO[bytes],
    found: list[Channel],
    metadata: Mapping[str, str],
    files: Mapping[str, bytes],
    start: int,
    compression: Compression,
) -> None:
    from mcap.writer import CompressionType, Writer

    kind = CompressionType.ZSTD if compression == "zstd" else CompressionType.NONE
    writer: Any = Writer(stream, chunk_size=CHUNK_BYTES, compression=kind)
    writer.start(profile="", library=f"gaitforge {__version__}")
    writer.add_metadata("gaitforge", {key: str(value) for key, value in metadata.items()})
    schemas: dict[tuple[str, bytes], int] = {}
    ids = []
    for channel in found:
        schema = channel.schema
        key = (schema.name, schema.data)
        if key not in schemas:
            schemas[key] = writer.register_schema(schema.name, schema.encoding, schema.data)
        ids.append(writer.register_channel(channel.topic, channel.message_encoding, schemas[key]))
    # Sorting is stable: at one instant the channels keep their order, the robot's description first.
    order = [(t, k, n) for k, channel in enumerate(found) for n, (t, _) in enumerate(channel.messages)]
    for t, k, n in sorted(order):
        writer.add_message(ids[k], t, found[k].messages[n][1], t, n)
    for name, data in files.items():
        writer.add_attachment(
            start, start, name, MEDIA_TYPES.get(os.path.splitext(name)[1], "application/octet-stream"), data
        )
    writer.finish()
