"""Contacts that no plan asks for, grouped into events."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.timeline import Timeline, TimelineSamples
from gaitforge.robot.model import RobotModel
from gaitforge.task.scene import Scene
from gaitforge.verify.feet import CONTACT_N
from gaitforge.verify.recording import GROUND, ContactTable, Recording
from gaitforge.verify.trace import UnplannedContact

Array = NDArray[np.float64]
PAUSE_S = 0.05
"""Contacts of one kind that are this close in time are one event [s]."""
What = tuple[str, str]
"""kind and words of an event"""


def unplanned_contacts(
    robot: RobotModel,
    recording: Recording,
    scene: Scene,
    foot: NDArray[np.intp],
    other_foot: NDArray[np.intp],
    swing_force: Array,
    grasps: NDArray[np.bool_] | None = None,
) -> tuple[UnplannedContact, ...]:
    """Everything but a planned foot on the ground, in the order of time.

    foot, other_foot (k,): limb whose foot sphere a contact lies on, for the link and for the other
    link of a self-contact; swing_force (n, n_F): see `force_in_swing`; grasps (n, n_F, n_objects): feet that are
    to touch an object then (None: none is).
    """
    table = recording.contacts
    forces: dict[What, Array] = {}
    for what, rows in _grouped(robot, recording.links, scene, table, foot, other_foot, grasps):
        total = forces.setdefault(what, np.zeros(len(recording.times)))
        np.add.at(total, table.step[rows], table.force[rows])
    for index, limb in enumerate(robot.limbs):
        if swing_force[:, index].any():
            forces["swing", f"{limb.name} foot on ground in swing"] = swing_force[:, index]
    events = [e for what, force in forces.items() for e in _events(what, force, recording.times)]
    return tuple(sorted(events, key=lambda e: (e.time, e.what)))


def force_in_swing(timeline: Timeline, plan: TimelineSamples, normal_force: Array) -> Array:
    """(n, n_F) normal force of feet that are planned to be in swing, and are so for longer than a column.

    A foot that is on the ground within one column of a planned stance is early or late, and is left out.
    """
    near = near_stance(plan.contact, plan.times, _column_durations(timeline, plan))
    return np.where(near, 0.0, normal_force)


def near_stance(contact: NDArray[np.bool_], times: Array, tolerance: Array) -> NDArray[np.bool_]:
    """(n, n_F) is there a planned stance of the foot within `tolerance` (n,) [s] of each time.

    Beyond both ends of the run a foot that ever stands may stand: a gait that stops in mid-cycle
    would have put it down next.
    """
    near = np.array(contact)
    for foot in range(contact.shape[1]):
        if not contact[:, foot].any():
            continue
        stance = np.unique(np.concatenate([times[[0]], times[contact[:, foot]], times[[-1]]]))
        after = np.searchsorted(stance, times)
        to_next = stance[np.minimum(after, len(stance) - 1)] - times
        to_last = times - stance[np.maximum(after - 1, 0)]
        near[:, foot] |= (np.minimum(np.abs(to_next), np.abs(to_last))) <= tolerance + 1e-9
    return near


def _column_durations(timeline: Timeline, plan: TimelineSamples) -> Array:
    durations = np.array([e.plan.duration / e.plan.pattern.columns for e in timeline.entries])
    return durations[plan.segment]


def _grouped(
    robot: RobotModel,
    links: tuple[str, ...],
    scene: Scene,
    table: ContactTable,
    foot: NDArray[np.intp],
    other_foot: NDArray[np.intp],
    grasps: NDArray[np.bool_] | None,
) -> Iterator[tuple[What, NDArray[np.intp]]]:
    """Contacts that are unplanned whatever the pattern says, by what touches what."""
    item = table.other - len(links)
    held = (item >= 0) & (foot >= 0) & (grasps is not None)
    if grasps is not None:
        held[held] = grasps[table.step[held], foot[held], item[held]]
    suspect = np.flatnonzero(((table.other != GROUND) | (foot < 0)) & ~held)
    keys = np.stack([table.link, foot, table.other, other_foot], axis=1)[suspect]
    if not len(suspect):
        return
    kinds, inverse = np.unique(keys, axis=0, return_inverse=True)
    owners = {link: limb.name for limb in robot.limbs for link in limb.links}
    for index, (link, f, other, g) in enumerate(kinds.tolist()):
        name = _part(robot, links[link], f, owners)
        rows = suspect[inverse.reshape(-1) == index]
        if other == GROUND:
            yield ("trunk" if name == "trunk" else "ground", f"{name} on ground"), rows
        elif other < len(links):
            first, second = sorted((name, _part(robot, links[other], g, owners)))
            yield ("self", f"{first} against {second}"), rows
        else:
            yield ("object", f"{name} against {scene.objects[other - len(links)].name}"), rows


def _part(robot: RobotModel, link: str, foot: int, owners: dict[str, str]) -> str:
    """A link in the words of a person: "L1 foot", "L1 shin" (the foot's link, not its sphere), "L1 <link>", "trunk"."""
    if foot >= 0:
        return f"{robot.limbs[foot].name} foot"
    owner = owners.get(link)
    if owner is None:
        return "trunk" if link == robot.base_link else f"trunk's {link}"
    if any(limb.foot.link == link for limb in robot.limbs):
        return f"{owner} shin"
    return link if link.startswith(owner) else f"{owner} {link}"


def _events(what: What, force: Array, times: Array) -> Iterator[UnplannedContact]:
    """One event per stretch of contact; breaks shorter than PAUSE_S do not count."""
    rows = np.flatnonzero(force > CONTACT_N)
    if not len(rows):
        return
    for stretch in np.split(rows, np.flatnonzero(np.diff(times[rows]) > PAUSE_S) + 1):
        first, last = float(times[stretch[0]]), float(times[stretch[-1]])
        yield UnplannedContact(first, what[1], float(force[stretch].max()), last, what[0])  # type: ignore[arg-type]
