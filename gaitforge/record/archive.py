"""``plan.npz``: every C and P exactly, and all that is needed to execute the timeline again.

Per segment, under its name: ``C`` (n_F, m) bool, ``P`` (n_J, N + 1) [rad], ``times`` (N + 1,) [s],
``base`` (N + 1, 6) [m, rad], ``com`` (N + 1, 3) [m], ``feet`` (N + 1, n_F, 3) [m], ``weights``
(N + 1, 2, n_F), ``info`` (JSON text: kind, command, roles, loads, stance, source, relaxed, what the solver said)
and, where the spline is clamped, ``joint_velocity_ends`` (2, n_J) and ``base_velocity_ends`` (2, 6).

The order in which segments run is in ``timeline/…`` (segment, cycles, start, origin, aims), the
joint rows that tool limbs recompute in ``override/<k>/…`` (a piecewise polynomial: x, c) and,
readable without knowing splines, in ``executed/…`` (times, joint_names, positions).
"""

from __future__ import annotations

import hashlib
import io
import json
import os
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.timeline import Timeline
from gaitforge.record.files import npz_bytes, write_bytes
from gaitforge.record.values import to_plain
from gaitforge.robot.model import RobotModel

CONTROL_HZ = 240.0
"""[1/s] rate at which the executed joint trajectory of tool limbs is written."""

Arrays = dict[str, NDArray[Any]]


def segment_names(timeline: Timeline) -> tuple[str, ...]:
    """A name for each entry: its plan's, with ``_2``, ``_3``… where different plans share one."""
    seen: dict[str, MotionPlan] = {}
    names = []
    for entry in timeline.entries:
        base, turn = entry.plan.name.replace("/", "_"), 1
        name = base
        while seen.setdefault(name, entry.plan) is not entry.plan:
            turn += 1
            name = f"{base}_{turn}"
        names.append(name)
    return tuple(names)


def plan_archive(timeline: Timeline) -> Arrays:
    """All arrays of ``plan.npz``, in the order in which they are written."""
    names = segment_names(timeline)
    arrays: Arrays = {
        "joint_names": np.array(timeline.robot.joint_names, dtype=np.str_),
        "limb_names": np.array(timeline.robot.limb_names, dtype=np.str_),
    }
    for name, entry in zip(names, timeline.entries, strict=True):
        if f"{name}/C" not in arrays:
            arrays |= _segment_arrays(name, entry.plan)
    arrays |= {
        "timeline/segment": np.array(names, dtype=np.str_),
        "timeline/cycles": np.array([e.cycles for e in timeline.entries], dtype=np.int64),
        "timeline/start": np.array([e.start for e in timeline.entries], dtype=np.float64),
        "timeline/origin": np.array([e.origin for e in timeline.entries], dtype=np.float64).reshape(-1, 3),
        "timeline/aims": _text(to_plain(tuple(timeline.aims))),
    }
    return arrays | _override_arrays(timeline)


def archive_bytes(timeline: Timeline) -> bytes:
    """The bytes of ``plan.npz``: the same for the same timeline."""
    return npz_bytes(plan_archive(timeline))


def write_plan_npz(path: str | os.PathLike[str], robot: RobotModel, timeline: Timeline) -> None:
    """Write ``plan.npz`` atomically; `robot` must be the timeline's.

    Raises
    ------
    InputError
        When the file cannot be written.
    ValueError
        When the timeline is another robot's.
    """
    if robot.joint_names != timeline.robot.joint_names:
        raise ValueError(f"a timeline of {timeline.robot.name} for the robot {robot.name}")
    write_bytes(path, archive_bytes(timeline))


def digest(array: NDArray[Any]) -> str:
    """SHA-256 of an array's values in C order: bool as one byte each, floats as little-endian float64."""
    values = np.asarray(array)
    stored = np.uint8 if values.dtype == np.bool_ else np.dtype("<f8")
    return hashlib.sha256(np.ascontiguousarray(values, dtype=stored).tobytes()).hexdigest()


def read_archive(data: bytes) -> Arrays:
    """The arrays of an archive's bytes."""
    with np.load(io.BytesIO(data), allow_pickle=False) as archive:
        return {name: archive[name] for name in archive.files}


def _segment_arrays(name: str, plan: MotionPlan) -> Arrays:
    arrays: Arrays = {
        "C": np.asarray(plan.pattern.contact, dtype=np.bool_),
        "P": np.asarray(plan.joint_positions, dtype=np.float64),
        "times": np.asarray(plan.times, dtype=np.float64),
        "base": np.asarray(plan.base_poses, dtype=np.float64),
        "com": np.asarray(plan.com, dtype=np.float64),
        "feet": np.asarray(plan.feet, dtype=np.float64),
        "weights": np.asarray(plan.weights, dtype=np.float64),
        "info": _text(_segment_info(plan)),
    }
    if plan.joint_velocity_ends is not None:
        arrays["joint_velocity_ends"] = np.asarray(plan.joint_velocity_ends, dtype=np.float64)
    if plan.base_velocity_ends is not None:
        arrays["base_velocity_ends"] = np.asarray(plan.base_velocity_ends, dtype=np.float64)
    return {f"{name}/{key}": value for key, value in arrays.items()}


def _segment_info(plan: MotionPlan) -> dict[str, Any]:
    # No seconds here: two equal runs must leave equal archives.
    report = plan.report
    return {
        "name": plan.name,
        "kind": plan.kind,
        "limbs": list(plan.pattern.limbs),
        "cyclic": plan.pattern.cyclic,
        "source": plan.pattern.source,
        "pattern_relaxed": list(plan.pattern.relaxed),
        "relaxed": list(plan.relaxed),
        "command": to_plain(plan.command),
        "roles": to_plain(dict(plan.roles)),
        "loads": to_plain(plan.loads),
        "holdings": to_plain(plan.holdings),
        "stance": to_plain(plan.stance),
        "report": {
            "status": report.status,
            "iterations": int(report.iterations),
            "cost": _finite(report.cost),
            "residual": _finite(report.residual),
        },
    }


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def _override_arrays(timeline: Timeline) -> Arrays:
    arrays: Arrays = {}
    for k, (row, spline, start, end) in enumerate(timeline.overrides):
        arrays |= {
            f"override/{k}/row": np.array(row, dtype=np.int64),
            f"override/{k}/x": np.asarray(spline.x, dtype=np.float64),
            f"override/{k}/c": np.asarray(spline.c, dtype=np.float64),
            f"override/{k}/window": np.array([start, end], dtype=np.float64),
        }
    if not timeline.overrides:
        return arrays
    rows = sorted({int(row) for row, *_ in timeline.overrides})
    times = np.arange(int(timeline.duration * CONTROL_HZ) + 1) / CONTROL_HZ
    return arrays | {
        "executed/times": times,
        "executed/joint_names": np.array([timeline.robot.joint_names[r] for r in rows], dtype=np.str_),
        "executed/positions": timeline.sample(times).joint_positions[:, rows].T,
    }


def _text(value: Any) -> NDArray[np.str_]:
    return np.array(json.dumps(value, ensure_ascii=False, allow_nan=False), dtype=np.str_)


def text(arrays: Mapping[str, NDArray[Any]], key: str) -> Any:
    """The JSON value kept under `key`."""
    return json.loads(str(arrays[key]))
