"""``run.layout.json``: how Foxglove and Lichtblick show a log; no viewer loads one from the log itself."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from gaitforge.motion.timeline import Timeline
from gaitforge.record.channels.footfall import field_name
from gaitforge.record.channels.transforms import PLAN_PREFIX, WORLD
from gaitforge.record.files import write_json
from gaitforge.record.panels import (
    image_panel,
    indicator_panel,
    log_panel,
    plot_panel,
    raw_panel,
    states_panel,
    table_panel,
    three_d_panel,
)
from gaitforge.robot.limbs import Limb
from gaitforge.robot.model import RobotModel

GREEN, RED, AMBER, BLUE = "#2f9d58", "#d0342c", "#e8a33d", "#3a6fc4"


def write_layout(path: str | os.PathLike[str], robot: RobotModel, timeline: Timeline, *, images: bool = False) -> None:
    """Write the layout, atomically; `images` adds a panel for what the camera saw.

    InputError when the file cannot be written.
    """
    write_json(path, layout(robot, timeline, images=images))


def layout(robot: RobotModel, timeline: Timeline, *, images: bool = False) -> dict[str, Any]:
    """The layout in the classic JSON form that both viewers import."""
    panels = _panels(robot, timeline)
    if images:
        panels["Image!camera"] = image_panel("Camera", "/camera/image")
    panels["Tab!main"] = {"activeTabIdx": 0, "tabs": _tabs(len(robot.limbs), images)}
    return {
        "configById": panels,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
        "layout": "Tab!main",
    }


def _panels(robot: RobotModel, timeline: Timeline) -> dict[str, dict[str, Any]]:
    limbs, shown = robot.limb_names, _interesting_limb(robot, timeline)
    states = [(f"/footfall/compare.{field_name(name)}", name) for name in limbs]
    forces = [(f'/sim/contacts.feet[:]{{name=="{name}"}}.normal_force', name) for name in limbs]
    return {
        "3D!main": _three_d(robot, timeline),
        "StateTransitions!feet": states_panel("Feet against plan: air · stance · early · late", states),
        "Image!matrix": image_panel("Footfall pattern C: red = swing", "/footfall/matrix", "/footfall/cursor"),
        "Plot!speed": plot_panel("Forward speed [m/s]", _metrics("speed", "speed_planned", "speed_cycle")),
        "Plot!joints": plot_panel(f"{shown.name}: joints, simulated and planned [rad]", _joints(shown)),
        "Plot!forces": plot_panel("Normal force of each foot [N]", forces),
        "Plot!margin": plot_panel("Static margin [m]", [*_metrics("margin"), ("0", "limit")]),
        "Plot!body": plot_panel("Tilt and heading against plan [deg]", _angles(timeline)),
        "Plot!ratios": plot_panel("Share of joint limits", _metrics("effort_ratio", "velocity_ratio")),
        "Plot!tracking": plot_panel("Joint tracking [rad]", _metrics("tracking_rms", "tracking_max")),
        "RosOut!log": log_panel("Log", "/log"),
        "Indicator!phase": indicator_panel(
            "Phase",
            "/state.phase",
            {"gait": (GREEN, "GAIT"), "transition": (AMBER, "TRANSITION"), "stand": (BLUE, "STAND")},
        ),
        "Indicator!verdict": indicator_panel(
            "Verdict", "/verify/report.verdict", {"verified": (GREEN, "VERIFIED"), "unverified": (RED, "UNVERIFIED")}
        ),
        "Table!checks": table_panel("Checks", "/verify/report.checks"),
        "RawMessages!segment": raw_panel("Segment", "/plan/segment"),
    }


def _three_d(robot: RobotModel, timeline: Timeline) -> dict[str, Any]:
    feet = robot.foot_positions(np.zeros(6), robot.nominal.posture)
    topics: dict[str, dict[str, Any]] = {
        "/viz/support": {"visible": True},
        "/viz/forces": {"visible": True},
        "/viz/footholds": {"visible": True},
        "/viz/scene": {"visible": True},
        "/plan/path": {
            "visible": True,
            "type": "line",
            "lineWidth": 0.01,
            "gradient": ["#2f9d58ff", "#2f9d58ff"],
        },
        "/sim/base": {"visible": False},
        "/robot_description": {"visible": False},
    }
    if any(entry.plan.holdings for entry in timeline.entries):
        topics["/viz/loads"] = {"visible": True}
    return three_d_panel(
        "Robot: simulated (solid) and planned (ghost)",
        follow=robot.base_link,
        world=WORLD,
        distance=round(3.0 * float(np.linalg.norm(feet[:, :2], axis=1).max()), 2),
        topics=topics,
        robots=(
            ("Simulated robot", "/robot_description", ""),
            ("Planned robot", "/plan/robot_description", PLAN_PREFIX),
        ),
    )


def _metrics(*names: str) -> list[tuple[str, str]]:
    return [(f"/metrics.{name}", name.replace("_", " ")) for name in names]


def _angles(timeline: Timeline) -> list[tuple[str, str]]:
    tools = dict.fromkeys(f"pointing_{aim.tool}" for aim in timeline.aims)
    return _metrics("tilt", "tilt_planned", "yaw_error", *tools)


def _joints(limb: Limb) -> list[tuple[str, str]]:
    return [
        (f'/{side}/joint_states.joints[:]{{name=="{joint}"}}.position', f"{joint} {side}")
        for joint in limb.joints
        for side in ("sim", "plan")
    ]


def _interesting_limb(robot: RobotModel, timeline: Timeline) -> Limb:
    """The limb whose job changes, or the first."""
    named = [aim.limb for aim in timeline.aims] + [limb for entry in timeline.entries for limb in entry.plan.roles]
    return robot.limb(named[0]) if named else robot.limbs[0]


def _tabs(limbs: int, images: bool) -> list[dict[str, Any]]:
    status = _row("RosOut!log", _row("Indicator!phase", "Indicator!verdict"), 70)
    view = _row("3D!main", "Image!camera", 68) if images else "3D!main"
    # State Transitions wants some 60 pixels a row.
    feet = min(74, 34 + 4 * limbs)
    right = _column("StateTransitions!feet", _column("Image!matrix", "Plot!speed", 45), feet)
    plots = _column(_row("Plot!forces", "Plot!joints"), _row("Plot!margin", _row("Plot!body", "Plot!tracking"), 34))
    checks = _column("RawMessages!segment", "Plot!ratios", 70)
    return [
        {"title": "Overview", "layout": _row(_column(view, status, 80), right, 54)},
        {"title": "Plots", "layout": plots},
        {"title": "Checks", "layout": _row("Table!checks", checks, 60)},
    ]


def _row(first: Any, second: Any, percent: int = 50) -> dict[str, Any]:
    return {"direction": "row", "splitPercentage": percent, "first": first, "second": second}


def _column(first: Any, second: Any, percent: int = 50) -> dict[str, Any]:
    return {"direction": "column", "splitPercentage": percent, "first": first, "second": second}
