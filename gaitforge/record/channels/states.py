"""`/sim/contacts` and `/metrics`: forces on the feet, and the numbers that verification looks at."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitforge.record.channels.channel import Channel, boolean, json_channel, number, objects, text
from gaitforge.record.derived import column_seconds, cycle_seconds, forward_speed, tilt, travel_direction
from gaitforge.record.run import Run

Array = NDArray[np.float64]

CONTACTS = {
    "feet": objects(
        {
            "name": text("limb"),
            "in_contact": boolean("presses with more than 1 N"),
            "force": number("[N] of the whole ground force"),
            "normal_force": number("[N]"),
        },
        "one a limb",
    )
}

UNITS = {
    "speed": "[m/s] mean over one column",
    "speed_planned": "[m/s] mean over one column",
    "speed_cycle": "[m/s] mean over one repetition of the segment",
    "margin": "[m] static margin from real contacts",
    "tilt": "[deg]",
    "tilt_planned": "[deg]",
    "height": "[m] of base_link",
    "height_planned": "[m] of base_link",
    "yaw_error": "[deg] against plan",
    "position_error": "[m] of base_link against plan, in the plane",
    "tracking_rms": "[rad] of all joints against plan",
    "tracking_max": "[rad] of the worst joint against plan",
    "effort_ratio": "largest joint effort over its limit",
    "velocity_ratio": "largest joint speed over its limit",
    "slip_speed": "[m/s] of the foot that slips most",
    "power": "[W] sum of |effort × speed|",
    "feet_down": "feet in contact",
    "feet_down_planned": "feet in contact by plan",
}

TOOL_UNITS = {
    "pointing": "[deg] angle between optical axis and target",
    "sight": "1: the line of sight to the target is free",
}


def state_channels(run: Run) -> list[Channel]:
    """States at the log's rate."""
    stamps = [run.stamp(t) for t in run.trace.times[run.rows]]
    values = metrics(run)
    units = {name: UNITS.get(name) or TOOL_UNITS[name.split("_")[0]] for name in values}
    columns = {name: column.tolist() for name, column in values.items()}
    rows = [{name: column[k] for name, column in columns.items() if np.isfinite(column[k])} for k in range(len(stamps))]
    fields = {name: number(unit) for name, unit in units.items()}
    return [
        json_channel("/sim/contacts", "gaitforge.Contacts", CONTACTS, zip(stamps, _contacts(run), strict=True)),
        json_channel("/metrics", "gaitforge.Metrics", fields, zip(stamps, rows, strict=True)),
    ]


def metrics(run: Run) -> dict[str, Array]:
    """Name → (n,) values at the log's rate; `UNITS` says what they are; NaN where there is no value."""
    trace, plan, rows = run.trace, run.trace.plan, run.rows
    error = trace.joint_positions - plan.joint_positions
    found = {
        **_speeds(run),
        "margin": trace.margin,
        "tilt": np.rad2deg(tilt(trace.base_poses)),
        "tilt_planned": np.rad2deg(tilt(plan.base_poses)),
        "height": trace.base_poses[:, 2],
        "height_planned": plan.base_poses[:, 2],
        "yaw_error": np.rad2deg(_wrapped(trace.base_poses[:, 5] - plan.base_poses[:, 5])),
        "position_error": np.linalg.norm(trace.base_poses[:, :2] - plan.base_poses[:, :2], axis=1),
        "tracking_rms": np.sqrt(np.mean(error**2, axis=1)),
        "tracking_max": np.abs(error).max(axis=1),
        "effort_ratio": np.abs(trace.joint_torques / _limit(run.robot.effort)).max(axis=1),
        "velocity_ratio": np.abs(trace.joint_velocities / _limit(run.robot.velocity)).max(axis=1),
        "slip_speed": trace.slip_speed.max(axis=1),
        "power": np.abs(trace.joint_torques * trace.joint_velocities).sum(axis=1),
        "feet_down": run.contact.sum(axis=1).astype(float),
        "feet_down_planned": plan.contact.sum(axis=1).astype(float),
    }
    for tool, angle in trace.pointing.items():
        found[f"pointing_{tool}"] = np.rad2deg(angle)
        if tool in trace.sight:
            found[f"sight_{tool}"] = np.where(np.isfinite(angle), trace.sight[tool], np.nan)
    return {name: values[rows] for name, values in found.items()}


def _speeds(run: Run) -> dict[str, Array]:
    trace, timeline = run.trace, run.timeline
    direction, column = travel_direction(timeline, trace), column_seconds(timeline, trace)
    return {
        "speed": forward_speed(trace.base_poses, direction, trace.times, column),
        "speed_planned": forward_speed(trace.plan.base_poses, direction, trace.times, column),
        "speed_cycle": forward_speed(trace.base_poses, direction, trace.times, cycle_seconds(timeline, trace)),
    }


def _contacts(run: Run) -> list[dict[str, object]]:
    trace, rows, names = run.trace, run.rows, run.robot.limb_names
    force = np.sqrt(trace.normal_force**2 + np.sum(trace.friction_force**2, axis=2))[rows].tolist()
    normal, contact = trace.normal_force[rows].tolist(), run.contact[rows].tolist()
    return [
        {
            "feet": [
                {"name": name, "in_contact": c, "force": f, "normal_force": n}
                for name, c, f, n in zip(names, contact[k], force[k], normal[k], strict=True)
            ]
        }
        for k in range(len(rows))
    ]


def _limit(limits: Array) -> Array:
    """Limits [·]; a joint without one counts for nothing."""
    return np.where(limits > 0, limits, np.inf)


def _wrapped(angle: Array) -> Array:
    return np.asarray((angle + np.pi) % (2 * np.pi) - np.pi)
