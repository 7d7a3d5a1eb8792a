"""Phases that pick up and put down, out of plain data."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from typing import TYPE_CHECKING, Any

from gaitforge.errors import InputError
from gaitforge.task.handling import GRASPS, GROUND, Pick, Place
from gaitforge.task.phase import Phase
from gaitforge.task.reader import Reader
from gaitforge.task.scene import Scene

if TYPE_CHECKING:
    from gaitforge.robot.model import RobotModel

NUMBERS: dict[str, tuple[str, Callable[[float], bool]]] = {
    "squeeze": ("a force > 0 [N]", lambda x: x > 0.0),
    "lift": ("a height > 0 [m]", lambda x: x > 0.0),
    "grip_height": ("a height [m]", lambda x: True),
    "grip_spread": ("a length > 0 [m]", lambda x: x > 0.0),
    "ready_aside": ("a length > 0 [m]", lambda x: x > 0.0),
    "ready_above": ("a height [m]", lambda x: True),
    "crouch": ("a height ≥ 0 [m]", lambda x: x >= 0.0),
}
HANDLING = tuple(dict.fromkeys(f.name for kind in (Pick, Place) for f in fields(kind)))
"""Keys of a phase that picks up or puts down."""


def handling_phase(reader: Reader, own: Mapping[str, Any], key: str) -> Phase:
    """A phase of kind *pick* or *place*; problems are noted by the reader."""
    kind = own["kind"]
    allowed = {f.name for f in fields(Pick if kind == "pick" else Place)}
    given = {k: v for k, v in own.items() if v is not None and k not in ("name", "kind") and v != {}}
    for name in given:
        if name not in allowed:
            reader.problem(f"{key}.{name}", repr(given[name]), f"nothing: a phase of kind {kind} has no such value")
    name = reader.text(own.get("name"), f"{key}.name")
    target = reader.text(given.get("object"), f"{key}.object")
    if kind == "place":
        onto = given.get("onto", GROUND)
        return Phase(name, "place", Place(target, reader.text(onto, f"{key}.onto")))
    limbs = tuple(str(v) for v in reader.listing(given.get("limbs"), f"{key}.limbs"))
    values = {
        k: reader.number(given[k], f"{key}.{k}", expected, good)
        for k, (expected, good) in NUMBERS.items()
        if k in given
    }
    grasp = given.get("grasp", GRASPS[0])
    if grasp not in GRASPS:
        reader.problem(f"{key}.grasp", repr(grasp), " or ".join(GRASPS))
    return Phase(name, "pick", Pick(target, limbs, **values, grasp=grasp))


def check_handling(reader: Reader, phases: Sequence[Phase], scene: Scene, robot: RobotModel | None) -> None:
    """What is picked up exists, is held by pairs of limbs that do nothing else, and is put down once or not at all.

    A task picks up before it walks and puts down after it, once or several times: where the feet stand in between is
    the gait's matter, and who picks up again has let go of everything.
    """
    kinds = [p.kind for p in phases]
    if not re.fullmatch("w+|(p+w+l*)+", "".join({"pick": "p", "walk": "w", "place": "l"}[k] for k in kinds)):
        reader.problem("phases", " → ".join(kinds), "phases that pick up, then walk, then put down")
    boxes = {o.name: o for o in scene.objects if o.kind == "box"}
    movable = [name for name, box in boxes.items() if box.mass > 0.0]
    held: dict[str, str] = {}
    picked: list[str] = []
    for index, phase in enumerate(phases):
        key, handling = f"phases.{index}", phase.handling
        if isinstance(handling, Pick):
            if handling.object not in movable:
                reader.problem(f"{key}.object", repr(handling.object), _one_of(movable, "a box with a mass"))
            if index and kinds[index - 1] != "pick" and held:
                still = ", ".join(dict.fromkeys(held.values()))
                reader.problem(f"{key}.object", f"{handling.object} while {still} is held", "that it is put down first")
            picked.append(handling.object)
            _check_limbs(reader, handling, f"{key}.limbs", held, robot)
        elif isinstance(handling, Place):
            if handling.object not in picked:
                reader.problem(f"{key}.object", repr(handling.object), _one_of(picked, "what has been picked up"))
            if handling.onto != GROUND and handling.onto not in boxes:
                reader.problem(f"{key}.onto", repr(handling.onto), _one_of([GROUND, *boxes], "ground or a box"))
            held = {name: what for name, what in held.items() if what != handling.object}
        for name in phase.roles:
            if (limb := _limb_name(robot, name)) in held:
                reader.problem(f"{key}.roles.{name}", "a limb that holds " + held[limb], "a limb that is free")
    reader.unique(picked, "phases", "every object picked up once")


def _check_limbs(reader: Reader, pick: Pick, key: str, held: dict[str, str], robot: RobotModel | None) -> None:
    names = [_limb_name(robot, n) for n in pick.limbs]
    unknown = [n for n in names if robot is not None and n not in robot.limb_names]
    if unknown and robot is not None:
        reader.problem(key, ", ".join(unknown), _one_of(robot.limb_names, "limbs"))
    reader.unique(names, key, "every limb once")
    for name in names:
        if name in held:
            reader.problem(key, f"{name}, which holds {held[name]}", "a limb that is free")
        held[name] = pick.object
    if robot is None or unknown:
        return
    sides = [robot.limb(n).side for n in names]
    if not names or sides.count("left") != sides.count("right") or "middle" in sides:
        reader.problem(key, ", ".join(names) or "none", "as many limbs on the left as on the right")


def _limb_name(robot: RobotModel | None, name: str) -> str:
    """The limb's own name; `name` itself where there is none."""
    if robot is None:
        return name
    try:
        return robot.limb(name).name
    except InputError:
        return name


def _one_of(names: Sequence[str], what: str) -> str:
    return f"{what}: " + (", ".join(names) or "there is none")
