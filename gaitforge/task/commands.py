"""Reading what a phase commands besides its speed: a posture, and loads."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from gaitforge.robot.payload import BODY, Load
from gaitforge.task.reader import Reader

if TYPE_CHECKING:
    from gaitforge.robot.limbs import Limb
    from gaitforge.robot.model import RobotModel


def read_posture(
    reader: Reader, value: Any, key: str, robot: RobotModel | None
) -> str | Mapping[str, tuple[float, ...]] | None:
    """A name, or limb → joint positions [rad]."""
    if value is None:
        return None
    if isinstance(value, str):
        known = () if robot is None else ("nominal", *robot.nominal.postures)
        return str(reader.choice(value, key, known)) if known else value
    found = {}
    for name, angles in reader.mapping(value, key).items():
        found[name] = reader.numbers(angles, f"{key}.{name}", "joint positions [rad]")
        limb = None if robot is None else next((x for x in robot.limbs if x.name == name), None)
        if robot is not None and limb is None:
            reader.problem(f"{key}.{name}", "an unknown limb", "one of " + ", ".join(robot.limb_names))
        elif robot is not None and limb is not None:
            _check_angles(reader, found[name], f"{key}.{name}", robot, limb)
    return found


def _check_angles(reader: Reader, angles: tuple[float, ...], key: str, robot: RobotModel, limb: Limb) -> None:
    rows = robot.joint_indices(limb)
    if len(angles) != len(rows):
        reader.problem(key, f"{len(angles)} values", f"{len(rows)} joint positions [rad]")
        return
    for joint, angle, low, high in zip(limb.joints, angles, robot.lower[rows], robot.upper[rows], strict=True):
        if not low <= angle <= high:
            reader.problem(key, f"{angle:g} for {joint}", f"between {low:g} and {high:g} [rad]")


def read_load(reader: Reader, value: Any, key: str, robot: RobotModel | None) -> Load:
    """Mass, point and frame of what is carried."""
    item = reader.mapping(value, key, ("mass", "point", "frame"))
    mass = reader.number(item.get("mass"), f"{key}.mass", "a mass > 0 [kg]", lambda x: x > 0)
    point = reader.vector(item.get("point"), f"{key}.point", "x, y, z [m]")
    frame = item.get("frame", BODY)
    if not isinstance(frame, str):
        reader.problem(f"{key}.frame", repr(frame), "body, or the name of a limb or tool")
    elif robot is not None:
        known = (BODY, *robot.limb_names, *(tool.name for tool in robot.tools))
        if frame not in known:
            reader.problem(f"{key}.frame", repr(frame), "one of " + ", ".join(known))
    return Load(mass if mass > 0 else 1.0, point, str(frame))
