"""The project's frozen values as plain JSON and back, without loss: ``{"Limb": {"name": "L1", …}}``.

Floats are written with all their digits, tuples become lists and lists tuples again, arrays
are ``{"array": [[…], …]}`` of float64.  Fields that a class does not know are left out when
reading, fields that a file does not know keep their default.
"""

from __future__ import annotations

import dataclasses
import json
from typing import Any

import numpy as np

from gaitforge.motion.manipulation.holding import Holding
from gaitforge.motion.plan import Command, Stance
from gaitforge.motion.timeline import Aim
from gaitforge.robot.limbs import Foot, Limb, ToolMount
from gaitforge.robot.model import Box, Capsule, Nominal, RobotModel
from gaitforge.robot.payload import Load
from gaitforge.task.roles import Carry, Failed, Held, Locomotive, Tool
from gaitforge.task.scene import Scene, SceneObject

CLASSES: dict[str, type] = {
    cls.__name__: cls
    for cls in (
        *(Foot, Limb, ToolMount, Nominal, Box, Capsule, RobotModel, Scene, SceneObject),
        *(Locomotive, Held, Failed, Tool, Carry, Command, Stance, Load, Holding, Aim),
    )
}


def to_plain(value: Any) -> Any:
    """`value` as JSON types."""
    if isinstance(value, np.ndarray):
        return {"array": value.astype(np.float64).tolist()}
    if isinstance(value, np.generic):
        return value.item()
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        name = type(value).__name__
        if name not in CLASSES:
            raise TypeError(f"{name} is none of the values that a log keeps: {', '.join(CLASSES)}")
        fields = {f.name: to_plain(getattr(value, f.name)) for f in dataclasses.fields(value) if f.init}
        return {name: fields}
    if isinstance(value, dict):
        return {"map": {str(key): to_plain(item) for key, item in value.items()}}
    if isinstance(value, (list, tuple)):
        return [to_plain(item) for item in value]
    return value


def from_plain(value: Any) -> Any:
    """The value that `to_plain` was given; KeyError for a class that a log does not keep."""
    if isinstance(value, list):
        return tuple(from_plain(item) for item in value)
    if not isinstance(value, dict):
        return value
    ((name, content),) = value.items()
    if name == "array":
        return np.array(content, dtype=np.float64)
    if name == "map":
        return {key: from_plain(item) for key, item in content.items()}
    cls = CLASSES[name]
    known = {f.name for f in dataclasses.fields(cls) if f.init}
    return cls(**{key: from_plain(item) for key, item in content.items() if key in known})


def dumps(value: Any) -> str:
    """`value` as one JSON text, the same for the same value."""
    return json.dumps(to_plain(value), ensure_ascii=False, allow_nan=False)


def loads(text: str | bytes) -> Any:
    """The value of a text that `dumps` wrote."""
    return from_plain(json.loads(text))
