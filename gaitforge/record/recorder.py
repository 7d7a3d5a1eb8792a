"""The group ``record`` of the config: how a run is logged."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass

from gaitforge.record.writer import Compression, write_log
from gaitforge.robot.model import RobotModel
from gaitforge.task.scene import Scene
from gaitforge.verify.verdict import Verdict


@dataclass(frozen=True)
class McapRecorder:
    """Writes MCAP logs for Foxglove and Lichtblick, and says what is drawn of a run."""

    rate_hz: float = 50.0
    """[1/s] states; above 60 viewers warn and plots drag"""
    scene_hz: float = 25.0
    """[1/s] drawings: support polygon and forces"""
    compression: Compression = "zstd"
    """zstd · none"""
    pictures: bool = True
    """draw every segment that walks, for ``report.html``"""
    clip: bool = False
    """draw the whole run as ``clip.webp``"""
    clip_hz: float = 10.0
    """[1/s] frames of the clip"""
    clip_size: tuple[int, int] = (480, 270)
    """[pixel] width and height of the clip"""

    def __post_init__(self) -> None:
        object.__setattr__(self, "clip_size", tuple(int(v) for v in self.clip_size))
        if len(self.clip_size) != 2 or min(self.clip_size) < 1:
            raise ValueError(f"clip_size is a width and a height [pixel], found {self.clip_size}")
        for name in ("rate_hz", "scene_hz", "clip_hz"):
            value = getattr(self, name)
            if not value > 0.0:
                raise ValueError(f"{name} is a rate above 0 [1/s], found {value}")

    def write(
        self,
        path: str | os.PathLike[str],
        robot: RobotModel,
        verdict: Verdict,
        *,
        scene: Scene | None = None,
        metadata: Mapping[str, str] | None = None,
        attachments: Mapping[str, bytes] | None = None,
        start_time_ns: int | None = None,
    ) -> None:
        """`write_log` with these settings."""
        write_log(
            path,
            robot,
            verdict,
            scene=scene,
            metadata=metadata,
            attachments=attachments,
            start_time_ns=start_time_ns,
            rate_hz=self.rate_hz,
            scene_hz=self.scene_hz,
            compression=self.compression,
        )
