"""Reading what fails during a phase: plain data → `Failure`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from gaitforge.errors import InputError
from gaitforge.task.phase import Failure, Phase
from gaitforge.task.reader import Reader
from gaitforge.task.roles import MODES, Locomotive

if TYPE_CHECKING:
    from gaitforge.robot.model import RobotModel

KEYS = ("limbs", "mode", "at")
"""What a task may say once for the failures of all its phases."""


def read_failure(
    reader: Reader, value: Any, key: str, common: Mapping[str, Any], robot: RobotModel | None
) -> Failure | None:
    """The failure that `value` describes, None when there is none; what it leaves open `common` says."""
    if value is None or value is False:
        return None
    own = reader.mapping({} if value is True else value, key, KEYS)
    item = {**common, **{k: v for k, v in own.items() if v is not None}}

    def where(name: str) -> str:
        return f"{key}.{name}" if own.get(name) is not None or name not in common else name

    limbs = [str(n) for n in reader.listing(item.get("limbs"), where("limbs"))]
    if not limbs:
        reader.problem(where("limbs"), "none", "at least one limb that fails")
    names = [_limb(reader, name, where("limbs"), robot) for name in limbs]
    reader.unique(names, where("limbs"), "every limb once")
    at = item.get("at")
    if at is not None:
        at = reader.number(at, where("at"), "a share of a cycle, 0 ≤ at < 1", lambda x: 0 <= x < 1)
    return Failure(tuple(names), reader.choice(item.get("mode", "locked"), where("mode"), MODES), at)


def _limb(reader: Reader, name: str, key: str, robot: RobotModel | None) -> str:
    """The limb's own name."""
    if robot is None:
        return name
    try:
        return robot.limb(name).name
    except InputError as error:
        reader.problem(key, repr(name), error.problems[0].expected)
        return name


def check_failures(reader: Reader, phases: Sequence[Phase], robot: RobotModel | None) -> None:
    """What fails walks until then and is asked for nothing afterwards, and a phase comes after it."""
    lost: set[str] = set()
    for index, phase in enumerate(phases):
        key = f"phases.{index}"
        for name, role in phase.roles.items():
            limb = robot.limb(name).name if robot is not None and not reader.problems else name
            if limb in lost:
                reader.problem(f"{key}.roles.{name}", "a limb that has failed before", "no role for it")
            if phase.failure is not None and limb in phase.failure.limbs and not isinstance(role, Locomotive):
                reader.problem(f"{key}.failure.limbs", repr(name), "limbs that walk in this phase")
        if phase.failure is None:
            continue
        for limb in phase.failure.limbs:
            if limb in lost:
                reader.problem(f"{key}.failure.limbs", repr(limb), "limbs that have not failed before")
        lost.update(phase.failure.limbs)
        if index == len(phases) - 1:
            reader.problem(f"{key}.failure", "the last phase", "a phase after it, to walk on with the other limbs")
