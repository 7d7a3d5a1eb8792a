"""Picture and clip of the main job for README and docs. ``python -m benchmarks.pictures [run.mcap] [folder]``

Executes the timeline of a log again (by default of a run of ``robot=dodecapod task=camera_leg`` made for
it) and draws ``camera_leg.png`` from the middle of its last gait and ``camera_leg.webp`` of the whole run.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from gaitforge.cli import main as gaitforge
from gaitforge.record.files import write_bytes
from gaitforge.record.reader import read_run
from gaitforge.verify.clips import render_clip
from gaitforge.verify.pictures import View, render
from gaitforge.verify.verify import verify_timeline

IMAGES = Path(__file__).parents[1] / "docs" / "images"
VIEW = View(distance=2.1, ahead=0.2)
CLIP = (400, 225)
"""[pixel]"""


def draw(log: Path, folder: Path) -> tuple[Path, Path]:
    """The files drawn of a log."""
    run = read_run(log)
    trace = verify_timeline(run.robot, run.timeline, run.scene).trace
    last = [entry for entry in run.timeline.entries if entry.plan.kind == "gait"][-1]
    middle = 0.5 * (last.start + last.end)
    (picture,) = render(run.robot, trace, run.scene, [middle], distance=VIEW.distance, ahead=VIEW.ahead)
    files = folder / "camera_leg.png", folder / "camera_leg.webp"
    write_bytes(files[0], picture)
    write_bytes(files[1], render_clip(run.robot, trace, run.scene, frames_hz=6.0, size=CLIP, view=VIEW))
    return files


def main(arguments: list[str]) -> int:
    """Draw, and say what was drawn."""
    with tempfile.TemporaryDirectory() as temporary:
        log = Path(arguments[0]) if arguments else Path(temporary) / "run.mcap"
        if not arguments:
            gaitforge(["robot=dodecapod", "task=camera_leg", f"hydra.run.dir={temporary}"])
        for file in draw(log, Path(arguments[1]) if len(arguments) > 1 else IMAGES):
            print(f"{file.name}: {file.stat().st_size / 1000:.0f} kB")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
