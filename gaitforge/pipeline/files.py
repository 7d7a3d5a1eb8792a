"""Which file of a run is written when; each one whole or not at all, ``summary.json`` last."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gaitforge.pipeline.manifest import config_hash, manifest
from gaitforge.pipeline.run import Run
from gaitforge.record.files import write_bytes, write_json, write_text

if TYPE_CHECKING:
    from gaitforge.motion.timeline import Timeline
    from gaitforge.robot.model import RobotModel
    from gaitforge.verify.verdict import Verdict

PICTURE = (640, 360)
"""[pixel] width and height of a picture in the report."""


def write_start_files(run: Run) -> None:
    """``robot.urdf`` and ``manifest.json``, known before anything is planned."""
    write_text(run.folder / "robot.urdf", run.robot.urdf)
    write_json(run.folder / "manifest.json", manifest(run.config, run.robot.urdf, run.options.seed))


def write_plan_files(folder: Path, robot: RobotModel, timeline: Timeline) -> None:
    """``plan.npz``, ``footfall.csv`` and ``footfall.png``: all that is known before the simulation."""
    from gaitforge.record import write_plan_npz
    from gaitforge.report.footfall_plot import write_footfall_csv, write_footfall_png

    write_plan_npz(folder / "plan.npz", robot, timeline)
    write_footfall_csv(folder / "footfall.csv", timeline)
    write_footfall_png(folder / "footfall.png", timeline)


def write_log_files(run: Run, verdict: Verdict) -> None:
    """``run.mcap``, ``run.layout.json``, ``speed.png`` and, if asked for, ``clip.webp``: what was simulated."""
    from gaitforge.record.layout import write_layout
    from gaitforge.report.speed_plot import write_speed_png

    metadata = {
        "robot": run.robot.name,
        "task": run.task.name,
        "seed": str(run.options.seed),
        "config_sha256": config_hash(run.config),
    }
    run.options.recorder.write(run.folder / "run.mcap", run.robot, verdict, scene=run.task.scene, metadata=metadata)
    write_layout(run.folder / "run.layout.json", run.robot, verdict.timeline, images=bool(verdict.trace.images))
    write_speed_png(run.folder / "speed.png", verdict)
    if run.options.recorder.clip:
        write_bytes(run.folder / "clip.webp", _clip(run, verdict))


def write_report(run: Run, summary: Mapping[str, Any], verdict: Verdict | None) -> None:
    """``report.html``, with the plots there are and a picture of every gait and transition; ``clash.png`` if any."""
    from gaitforge.report.clash_plot import write_clash_png
    from gaitforge.report.page import write_report_html

    write_clash_png(run.folder / "clash.png", summary["explain"] or {})
    footfall, speed, clash = (_bytes(run.folder / name) for name in ("footfall.png", "speed.png", "clash.png"))
    pictures = _pictures(run, verdict) if verdict else []
    clip = "clip.webp" if (run.folder / "clip.webp").exists() else None
    write_report_html(
        run.folder / "report.html",
        summary,
        footfall_png=footfall,
        speed_png=speed,
        clash_png=clash,
        pictures=pictures,
        clip=clip,
    )


def _pictures(run: Run, verdict: Verdict) -> list[tuple[str, bytes]]:
    """(caption, PNG) from the middle of every segment that walks; none where there is no renderer."""
    from gaitforge.verify.pictures import render, view_of
    from gaitforge.verify.pybullet.client import has_pybullet

    if not run.options.recorder.pictures or not has_pybullet():
        return []
    walking = [e for e in verdict.timeline.entries if e.plan.kind != "stand"]
    times = [0.5 * (e.start + e.end) for e in walking]
    drawn = render(run.robot, verdict.trace, run.task.scene, times, PICTURE, yaw_deg=view_of(run.task.scene).yaw_deg)
    return [(f"{e.plan.name}, {t:.1f} s", png) for e, t, png in zip(walking, times, drawn, strict=True)]


def _clip(run: Run, verdict: Verdict) -> bytes:
    from gaitforge.verify.clips import render_clip

    recorder, scene = run.options.recorder, run.task.scene
    return render_clip(run.robot, verdict.trace, scene, frames_hz=recorder.clip_hz, size=recorder.clip_size)


def _bytes(path: Path) -> bytes | None:
    return path.read_bytes() if path.exists() else None
