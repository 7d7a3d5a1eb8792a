"""`/plan/segment` and `/state`: which segment runs, and the fingerprints of its C and P."""

from __future__ import annotations

from typing import Any

import numpy as np

from gaitforge.record.archive import digest, segment_names
from gaitforge.record.channels.channel import Channel, array, json_channel, number, text
from gaitforge.record.columns import columns_of
from gaitforge.record.run import Run

SEGMENT = {
    "name": text("name in plan.npz"),
    "kind": text("gait · transition · stand"),
    "start_s": number("[s]"),
    "end_s": number("[s]"),
    "cycles": number("repetitions"),
    "duration_s": number("[s] of one repetition"),
    "columns": number("m"),
    "samples_per_column": number("r"),
    "source": text("where the pattern comes from"),
    "limbs": array({"type": "string"}, "rows of C"),
    "locomotive": array({"type": "string"}, "limbs that walk"),
    "roles": array({"type": "string"}, "limb: role of the others"),
    "contact": array({"type": "string"}, "C row by row, 1 = stance"),
    "speed_planned_m_s": number("[m/s]"),
    "speed_measured_m_s": number("[m/s]"),
    "shape_C": array({"type": "integer"}, "(n_F, m)"),
    "shape_P": array({"type": "integer"}, "(n_J, r·m + 1)"),
    "sha256_C": text("of C as bytes 0 and 1, row by row"),
    "sha256_P": text("of P as little-endian float64, row by row"),
}

STATE = {
    "phase": text("kind of the segment"),
    "segment": text("name of the segment"),
    "cycle": number("which repetition, from 1"),
    "limbs": array({"type": "string"}, "limbs that walk"),
    "nonlocomotive": array({"type": "string"}, "limbs that do not"),
}


def segment_channels(run: Run) -> list[Channel]:
    """One message a segment, and one a repetition."""
    names = segment_names(run.timeline)
    segments = [(run.stamp(e.start), _segment(run, k, names[k])) for k, e in enumerate(run.timeline.entries)]
    columns = columns_of(run.timeline)
    states = []
    for row in np.flatnonzero(columns.column == 0):
        segment = int(columns.segment[row])
        plan = run.timeline.entries[segment].plan
        walking = list(plan.pattern.locomotive)
        state = {
            "phase": plan.kind,
            "segment": names[segment],
            "cycle": int(columns.cycle[row]) + 1,
            "limbs": walking,
            "nonlocomotive": [name for name in plan.pattern.limbs if name not in walking],
        }
        states.append((run.stamp(columns.times[row]), state))
    return [
        json_channel("/plan/segment", "gaitforge.Segment", SEGMENT, segments),
        json_channel("/state", "gaitforge.State", STATE, states),
    ]


def _segment(run: Run, index: int, name: str) -> dict[str, Any]:
    entry = run.timeline.entries[index]
    plan, contact = entry.plan, entry.plan.pattern.contact
    message: dict[str, Any] = {
        "name": name,
        "kind": plan.kind,
        "start_s": entry.start,
        "end_s": entry.end,
        "cycles": entry.cycles,
        "duration_s": plan.duration,
        "columns": plan.pattern.columns,
        "samples_per_column": plan.samples_per_column,
        "source": plan.pattern.source,
        "limbs": list(plan.pattern.limbs),
        "locomotive": list(plan.pattern.locomotive),
        "roles": [f"{limb}: {type(role).__name__.lower()}" for limb, role in plan.roles.items()],
        "contact": ["".join("1" if c else "0" for c in row) for row in contact],
        "speed_planned_m_s": plan.speed,
        "shape_C": list(contact.shape),
        "shape_P": list(plan.joint_positions.shape),
        "sha256_C": digest(contact),
        "sha256_P": digest(plan.joint_positions),
    }
    if index < len(run.verdict.speeds) and np.isfinite(run.verdict.speeds[index]):
        message["speed_measured_m_s"] = float(run.verdict.speeds[index])
    return message
