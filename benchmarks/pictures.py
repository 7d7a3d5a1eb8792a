"""Pictures and clips of every demonstration, for README and docs: ``python -m benchmarks.pictures [names …]``

Runs each demonstration (all, or those named) and draws its log: stills as PNG, the run as WebP.
``--runs FOLDER`` keeps the runs; those that are in it already are drawn without being made again.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gaitforge.cli import main as gaitforge
from gaitforge.record.files import write_bytes
from gaitforge.record.poses import RecordedPoses, recorded_poses
from gaitforge.record.reader import RunLog, read_run
from gaitforge.verify.clips import webp
from gaitforge.verify.pictures import View, frames, render, view_of

IMAGES = Path(__file__).parents[1] / "docs" / "images"
CLIP, FRAMES_HZ = (360, 202), 5.0
"""[pixel], [Hz]"""


@dataclass(frozen=True)
class Demonstration:
    """A run, or two runs side by side, and what is drawn of it."""

    command: tuple[str, ...]
    stills: tuple[tuple[str, str], ...] = ()
    """(name of the file, segment of whose middle it is)"""
    view: View | None = None
    logs: tuple[str, ...] = ("run.mcap",)
    """In the run's folder; two of an experiment are drawn side by side"""


def _side_by_side(experiment: str, pair: str) -> Demonstration:
    """A transition blended by equation (3) on the left, optimised on the right."""
    only = f"experiment.only=[{pair}.*]"
    pybullet = "~experiment.simulators.mujoco"
    logs = tuple(f"logs/{pair}.{method}.pybullet.mcap" for method in ("interpolate", "optimise"))
    return Demonstration((f"experiment={experiment}", only, "experiment.logs=true", pybullet), logs=logs)


DEMONSTRATIONS = {
    "camera_leg": Demonstration(
        ("robot=dodecapod", "task=camera_leg"), (("camera_leg", "inspect"),), View(distance=2.1, ahead=0.2)
    ),
    "carry_front": Demonstration(("robot=hexapod", "task=carry_front"), (("carry_front", "carry"),)),
    "carry_middle": Demonstration(("robot=hexapod", "task=carry_middle"), (("carry_middle", "carry"),)),
    "carry_both": Demonstration(
        ("robot=hexapod", "task=carry_both"), (("carry_both_box", "carry_box"), ("carry_both_tray", "carry_tray"))
    ),
    "carry_large": Demonstration(("robot=dodecapod", "task=carry_large"), (("carry_large", "carry"),)),
    "limb_failure": Demonstration(
        ("robot=dodecapod", "task=limb_failure", "task.limbs=[L3,L6,R1,R4]"), (("limb_failure", "without"),)
    ),
    "limp_limbs": Demonstration(
        ("robot=hexapod", "task=limb_failure", "task.limbs=[L3,R3]", "task.mode=limp"),
        (("limp_limbs", "without"),),
        View(distance=1.5, ahead=0.1),
    ),
    "table1": _side_by_side("table1", "hexapod.six_to_four"),
    "quadruped": _side_by_side("quadruped", "quadruped.sides_to_wave"),
}


def run(demonstration: Demonstration, folder: Path) -> list[RunLog]:
    """Its logs, from a run made in the folder unless they are there."""
    files = [folder / name for name in demonstration.logs]
    if not all(file.exists() for file in files):
        code = gaitforge([*demonstration.command, f"hydra.run.dir={folder}"])
        if code:
            raise SystemExit(f"{' '.join(demonstration.command)} ended with {code}: there is nothing to show")
    return [read_run(file) for file in files]


def draw(name: str, logs: list[RunLog], folder: Path) -> list[Path]:
    """The files drawn: stills of the first log, and the clip of all."""
    demonstration, files = DEMONSTRATIONS[name], []
    first, poses = logs[0], [recorded_poses(log) for log in logs]
    view = demonstration.view or view_of(first.scene)
    for file, segment in demonstration.stills:
        (entry,) = (e for e in first.timeline.entries if e.plan.name == segment)
        middle = [0.5 * (entry.start + entry.end)]
        look = {"yaw_deg": view.yaw_deg, "pitch_deg": view.pitch_deg, "ahead": view.ahead}
        (picture,) = render(first.robot, poses[0], first.scene, middle, distance=view.distance, **look)
        files.append(folder / f"{file}.png")
        write_bytes(files[-1], picture)
    files.append(folder / f"{name}.webp")
    write_bytes(
        files[-1], webp(_beside([_frames(log, p, view) for log, p in zip(logs, poses, strict=True)]), FRAMES_HZ)
    )
    return files


def _frames(log: RunLog, poses: RecordedPoses, view: View) -> Iterator[NDArray[np.uint8]]:
    times = np.arange(poses.times[0], poses.times[-1], 1.0 / FRAMES_HZ).tolist()
    return frames(log.robot, poses, log.scene, times, CLIP, view)


def _beside(clips: list[Iterator[NDArray[np.uint8]]]) -> Iterator[NDArray[np.uint8]]:
    """Frames of all clips in one picture; one that has ended keeps its last frame."""
    last: list[NDArray[np.uint8]] = [np.zeros((*CLIP[::-1], 3), dtype=np.uint8)] * len(clips)
    for shown in zip_longest(*clips):
        last = [before if now is None else now.copy() for now, before in zip(shown, last, strict=True)]
        yield np.concatenate(last, axis=1)


def main(arguments: list[str]) -> int:
    """Run, draw, and say what was drawn."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.pictures", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="name", help="of " + ", ".join(DEMONSTRATIONS))
    parser.add_argument("--folder", type=Path, default=IMAGES, help="where pictures go")
    parser.add_argument("--runs", type=Path, default=None, help="where runs are kept, and looked for")
    asked = parser.parse_args(arguments)
    if unknown := set(asked.names) - set(DEMONSTRATIONS):
        parser.error(f"no demonstration {', '.join(sorted(unknown))}; there are {', '.join(DEMONSTRATIONS)}")
    with tempfile.TemporaryDirectory() as temporary:
        for name in asked.names or DEMONSTRATIONS:
            logs = run(DEMONSTRATIONS[name], (asked.runs or Path(temporary)) / name)
            for file in draw(name, logs, asked.folder):
                print(f"{file.name}: {file.stat().st_size / 1000:.0f} kB")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
