"""Panels of a viewer's layout, as both viewers understand them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

Paths = Sequence[tuple[str, str]]
"""(message path, label) of what a panel shows"""


def three_d_panel(
    title: str,
    *,
    follow: str,
    world: str,
    distance: float,
    topics: Mapping[str, Any],
    robots: Sequence[tuple[str, str, str]],
) -> dict[str, Any]:
    """A 3D view that walks along with frame `follow`; `robots` are (label, URDF topic, frame prefix)."""
    layers: dict[str, Any] = {"grid": _grid(world)}
    for order, (label, topic, prefix) in enumerate(robots, start=2):
        layers[f"robot{order}"] = _urdf(f"robot{order}", label, topic, prefix, order)
    return {
        **_title(title),
        "cameraState": {
            "perspective": True,
            "distance": distance,
            "phi": 60,
            "thetaOffset": 40,
            "targetOffset": [0, 0, 0.05],
            "target": [0, 0, 0],
            "targetOrientation": [0, 0, 0, 1],
            "fovy": 45,
            "near": 0.01,
            "far": 500,
        },
        "followMode": "follow-position",
        "followTf": follow,
        "scene": {
            "backgroundColor": "#f4f6f8",
            "transforms": {"showLabel": False, "axisScale": 0, "lineWidth": 0, "enablePreloading": False},
            "labelScaleFactor": 0.5,
            "meshUpAxis": "z_up",
        },
        "transforms": {},
        "publish": {"type": "point"},
        "imageMode": {},
        "topics": dict(topics),
        "layers": layers,
    }


def plot_panel(title: str, paths: Paths) -> dict[str, Any]:
    """Curves over time."""
    curves = [
        {"value": value, "label": label, "enabled": True, "timestampMethod": "receiveTime", "showLine": True}
        for value, label in paths
    ]
    return {
        **_title(title),
        "paths": curves,
        "showLegend": True,
        "legendDisplay": "left",
        "showPlotValuesInLegend": False,
        "showXAxisLabels": True,
        "showYAxisLabels": True,
        "isSynced": True,
        "xAxisVal": "timestamp",
        "sidebarDimension": 130,
    }


def states_panel(title: str, paths: Paths) -> dict[str, Any]:
    """A coloured row a path: booleans or enums, for strings may share a colour."""
    rows = [{"value": v, "label": label, "enabled": True, "timestampMethod": "receiveTime"} for v, label in paths]
    return {**_title(title), "isSynced": True, "paths": rows}


def image_panel(title: str, topic: str, annotations: str | None = None) -> dict[str, Any]:
    """A picture, with drawings over it."""
    mode: dict[str, Any] = {"imageTopic": topic}
    if annotations:
        mode["annotations"] = {annotations: {"visible": True}}
    empty: dict[str, Any] = {
        "cameraState": {},
        "scene": {},
        "layers": {},
        "topics": {},
        "transforms": {},
        "publish": {},
    }
    return {**_title(title), **empty, "imageMode": mode}


def indicator_panel(title: str, path: str, colors: Mapping[str, tuple[str, str]]) -> dict[str, Any]:
    """A word on a colour; `colors` is value → (colour, label)."""
    rules = [
        {"operator": "=", "rawValue": value, "color": color, "label": label} for value, (color, label) in colors.items()
    ]
    fallback = {"fallbackColor": "#a0a0a0", "fallbackLabel": "–"}
    return {**_title(title), "path": path, "style": "background", **fallback, "rules": rules}


def log_panel(title: str, topic: str) -> dict[str, Any]:
    """Log lines."""
    return {**_title(title), "searchTerms": [], "minLogLevel": 1, "topicToRender": topic}


def table_panel(title: str, path: str) -> dict[str, Any]:
    """A list of objects as a table."""
    return {**_title(title), "topicPath": path}


def raw_panel(title: str, path: str) -> dict[str, Any]:
    """Messages as they are."""
    difference = {"diffEnabled": False, "diffMethod": "custom", "diffTopicPath": "", "showFullMessageForDiff": False}
    return {**_title(title), "topicPath": path, **difference}


def _title(title: str) -> dict[str, str]:
    # Each viewer reads its own key.
    return {"foxglovePanelTitle": title, "lichtblickPanelTitle": title}


def _grid(world: str) -> dict[str, Any]:
    return {
        "instanceId": "grid",
        "layerId": "foxglove.Grid",
        "label": "Ground, 0.1 m",
        "visible": True,
        "frameLocked": True,
        "frameId": world,
        "size": 10,
        "divisions": 100,
        "lineWidth": 1,
        "color": "#c0c8d0ff",
        "position": [0, 0, -0.001],
        "rotation": [0, 0, 0],
        "order": 1,
    }


def _urdf(instance: str, label: str, topic: str, prefix: str, order: int) -> dict[str, Any]:
    return {
        "instanceId": instance,
        "layerId": "foxglove.Urdf",
        "label": label,
        "visible": True,
        "frameLocked": True,
        "sourceType": "topic",
        "topic": topic,
        "framePrefix": prefix,
        "displayMode": "auto",
        "controlMode": "transforms",
        "order": order,
    }
