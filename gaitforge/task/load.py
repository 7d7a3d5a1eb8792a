"""Plain data (YAML, JSON) → `Task`, with every problem of the task reported together."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from gaitforge.errors import InputError
from gaitforge.task.commands import read_load, read_posture
from gaitforge.task.failures import KEYS as FAILURE_KEYS
from gaitforge.task.failures import check_failures, read_failure
from gaitforge.task.load_handling import HANDLING, check_handling, handling_phase
from gaitforge.task.phase import Phase, Task
from gaitforge.task.reader import Reader
from gaitforge.task.roles import MODES, Failed, Held, Locomotive, Role, Tool
from gaitforge.task.scene import Scene, SceneObject

if TYPE_CHECKING:
    from gaitforge.robot.model import RobotModel

COMMON = (
    "gait", "cycles", "speed", "heading", "yaw_rate", "body_height", "roll", "pitch", "step_height", "posture",
    "duration", "columns", "loads",
)  # fmt: skip
"""What a task may say once for all its phases."""
METHODS = ("auto", "tripod", "wave", "program")
DEFAULT_CYCLES = 2
RESERVED = ("start", "stop")


def load_task(data: Mapping[str, Any], name: str, *, robot: RobotModel | None = None, file: str = "") -> Task:
    """The task that `data` describes.

    `data` has ``phases`` (a list, or name → phase), ``scene`` (a list) and the values of `COMMON` for
    the phases that do not give their own; None counts as not given. With a `robot`, limbs, tools and
    hand-written patterns are checked against it. Raises `InputError` with all problems found; `file`
    names the source in them.
    """
    reader = Reader(file or f"task {name}")
    top = reader.mapping(data, "", ("phases", "scene", *COMMON, *FAILURE_KEYS))
    scene = _scene(reader, top.get("scene"))
    phases = _phases(reader, top, scene, robot)
    if reader.problems:
        raise InputError(reader.problems)
    return Task(name, phases, scene)


def _scene(reader: Reader, value: Any) -> Scene:
    items = [_scene_object(reader, item, f"scene.{i}") for i, item in enumerate(reader.listing(value, "scene"))]
    reader.unique([o.name for o in items], "scene", "an object of its own name")
    return Scene(tuple(items))


def _scene_object(reader: Reader, value: Any, key: str) -> SceneObject:
    item = reader.mapping(value, key, ("name", "kind", "pose", "radius", "length", "thickness", "size", "mass"))
    pose = reader.mapping(item.get("pose"), f"{key}.pose", ("xyz", "rpy"))
    zero = (0.0, 0.0, 0.0)
    optional: dict[str, Any] = {}
    for name in ("radius", "length", "thickness"):
        if item.get(name) is not None:
            optional[name] = reader.number(item[name], f"{key}.{name}", "a length > 0 [m]", lambda x: x > 0)
    if item.get("mass") is not None:
        optional["mass"] = reader.number(item["mass"], f"{key}.mass", "a mass ≥ 0 [kg]", lambda x: x >= 0)
    if item.get("size") is not None:
        optional["size"] = reader.vector(item["size"], f"{key}.size", "three lengths [m]")
    return SceneObject(
        reader.text(item.get("name"), f"{key}.name"),
        reader.choice(item.get("kind"), f"{key}.kind", ("pipe", "box")),
        xyz=reader.vector(pose.get("xyz", zero), f"{key}.pose.xyz", "x, y, z [m]"),
        rpy=reader.vector(pose.get("rpy", zero), f"{key}.pose.rpy", "roll, pitch, yaw [rad]"),
        **optional,
    )


def _phases(reader: Reader, top: Mapping[str, Any], scene: Scene, robot: RobotModel | None) -> tuple[Phase, ...]:
    value = top.get("phases")
    if isinstance(value, Mapping):
        value = [{"name": n, **p} if isinstance(p, Mapping) else p for n, p in value.items()]
    given = reader.listing(value, "phases")
    if not given and not reader.problems:
        reader.problem("phases", "none", "at least one phase")
    common = {k: top[k] for k in (*COMMON, *FAILURE_KEYS) if top.get(k) is not None}
    phases = tuple(_phase(reader, p, f"phases.{i}", common, scene, robot) for i, p in enumerate(given))
    reader.unique([p.name for p in phases], "phases", "a phase of its own name")
    check_handling(reader, phases, scene, robot)
    for phase in phases:
        if phase.name in RESERVED:
            reader.problem("phases", repr(phase.name), "another name: stands are called " + " and ".join(RESERVED))
    check_failures(reader, phases, robot)
    return phases


def _phase(
    reader: Reader, value: Any, key: str, common: Mapping[str, Any], scene: Scene, robot: RobotModel | None
) -> Phase:
    own = reader.mapping(value, key, ("name", "kind", "roles", "failure", *COMMON, *HANDLING))
    if own.get("kind") in ("pick", "place"):
        return handling_phase(reader, own, key)
    for name in HANDLING:
        if own.get(name) is not None:
            reader.problem(f"{key}.{name}", repr(own[name]), "nothing: a phase that walks handles no object")
    ours, failing = ({k: v for k, v in common.items() if k in keys} for keys in (COMMON, FAILURE_KEYS))
    item = {**ours, **{k: v for k, v in own.items() if v is not None}}

    def where(name: str) -> str:
        return f"{key}.{name}" if own.get(name) is not None or name not in common else name

    def number(name: str, expected: str, good: Callable[[float], bool]) -> float | None:
        return None if name not in item else reader.number(item[name], where(name), expected, good)

    def count(name: str, expected: str) -> int | None:
        return None if name not in item else reader.count(item[name], where(name), expected)

    roles = _roles(reader, item.get("roles"), f"{key}.roles", scene, robot)
    gait = _gait(reader, item.get("gait", "auto"), where("gait"), robot)
    if not isinstance(gait, str):
        _check_rows(reader, gait, where("gait"), roles, robot)
    return Phase(
        name=reader.text(item.get("name"), f"{key}.name"),
        kind=reader.choice(item.get("kind", "walk"), f"{key}.kind", ("walk", "pick", "place")),
        cycles=count("cycles", "a number of cycles ≥ 1") or DEFAULT_CYCLES,
        roles=roles,
        gait=gait,
        speed=number("speed", "a speed ≥ 0 [m/s]", lambda x: x >= 0),
        heading=number("heading", "an angle [rad]", lambda x: True) or 0.0,
        yaw_rate=number("yaw_rate", "a yaw rate [rad/s]", lambda x: True) or 0.0,
        body_height=number("body_height", "a height > 0 [m]", lambda x: x > 0),
        roll=number("roll", "an angle within ±0.5 [rad]", lambda x: abs(x) <= 0.5) or 0.0,
        pitch=number("pitch", "an angle within ±0.5 [rad]", lambda x: abs(x) <= 0.5) or 0.0,
        step_height=number("step_height", "a height > 0 [m]", lambda x: x > 0),
        posture=read_posture(reader, item.get("posture"), where("posture"), robot),
        duration="auto"
        if item.get("duration") == "auto"
        else number("duration", "a time > 0 [s], or auto", lambda x: x > 0),
        columns=count("columns", "a number of columns ≥ 1"),
        failure=read_failure(reader, own.get("failure"), f"{key}.failure", failing, robot),
        loads=tuple(
            read_load(reader, value, f"{where('loads')}.{i}", robot)
            for i, value in enumerate(reader.listing(item.get("loads"), where("loads")))
        ),
    )


def _gait(reader: Reader, value: Any, key: str, robot: RobotModel | None) -> str | Mapping[str, str]:
    if not isinstance(value, Mapping):
        method: str = reader.choice(value, key, METHODS)
        return method
    rows = {str(limb): "".join(map(str, row)) if isinstance(row, list | tuple) else str(row)
            for limb, row in value.items()}  # fmt: skip
    for limb, row in rows.items():
        if not row or set(row) - {"0", "1"}:
            reader.problem(f"{key}.{limb}", repr(row), "a row of 0 (swing) and 1 (stance)")
        if robot is not None and limb not in robot.limb_names:
            reader.problem(f"{key}.{limb}", "an unknown limb", "one of " + ", ".join(robot.limb_names))
    if len({len(row) for row in rows.values()}) > 1:
        reader.problem(key, "rows of different length", "the same number of columns for every limb")
    missing = [n for n in robot.limb_names if n not in rows] if robot is not None else []
    if missing:
        reader.problem(key, "no row for " + ", ".join(missing), "a row for every limb")
    return rows


def _check_rows(
    reader: Reader, rows: Mapping[str, str], key: str, roles: Mapping[str, Role], robot: RobotModel | None
) -> None:
    """A limb that walks stands at some time, one that does not never stands."""
    carriers = {t.name: t.limb for t in robot.tools} if robot is not None else {}
    free = {carriers.get(name, name) for name, role in roles.items() if not isinstance(role, Locomotive)}
    for limb, row in rows.items():
        if limb in free and "1" in row:
            reader.problem(f"{key}.{limb}", repr(row), "zeros only: the limb does not walk in this phase")
        if limb not in free and "1" not in row:
            reader.problem(f"{key}.{limb}", repr(row), "a 1 at least once, or another role for the limb")


def _roles(reader: Reader, value: Any, key: str, scene: Scene, robot: RobotModel | None) -> dict[str, Role]:
    roles: dict[str, Role] = {}
    limbs: list[str] = []
    for limb, given in reader.mapping(value, key).items():
        roles[limb] = _role(reader, given, f"{key}.{limb}", scene)
        if robot is not None:
            limbs.append(_check_limb(reader, roles[limb], f"{key}.{limb}", limb, robot))
    reader.unique([n for n in limbs if n], key, "one role for a limb")
    return roles


def _check_limb(reader: Reader, role: Role, key: str, name: str, robot: RobotModel) -> str:
    """The limb's own name; "" when there is none."""
    try:
        limb = robot.limb(name)
    except InputError as error:
        reader.problem(key, "no limb and no tool of this name", error.problems[0].expected)
        return ""
    if isinstance(role, Tool) and robot.tool(limb.name) is None:
        carriers = ", ".join(f"{t.limb} ({t.name})" for t in robot.tools if t.kind == "camera") or "none has one"
        reader.problem(key, f"limb {limb.name} without a camera", f"a limb that carries a camera: {carriers}")
    if isinstance(role, Held | Failed) and role.posture is not None and len(role.posture) != len(limb.joints):
        expected = f"{len(limb.joints)} joint positions [rad]"
        reader.problem(f"{key}.posture", f"{len(role.posture)} values", expected)
    return limb.name


def _role(reader: Reader, value: Any, key: str, scene: Scene) -> Role:
    item = {"role": value} if isinstance(value, str) else dict(reader.mapping(value, key))
    kind = reader.choice(item.pop("role", None), f"{key}.role", ("locomotive", "held", "failed", "tool"))
    allowed = {"held": ("posture",), "failed": ("mode", "posture"), "tool": ("look_at", "frame")}.get(kind, ())
    item = dict(reader.mapping(item, key, allowed))
    posture = item.get("posture")
    if posture is not None:
        posture = reader.numbers(posture, f"{key}.posture", "joint positions [rad]")
    if kind == "held":
        return Held(posture)
    if kind == "failed":
        return Failed(reader.choice(item.get("mode", "locked"), f"{key}.mode", MODES), posture)
    if kind == "tool":
        frame = reader.choice(item.get("frame", "world"), f"{key}.frame", ("world", "body"))
        return Tool(_target(reader, item.get("look_at"), f"{key}.look_at", scene), frame)
    return Locomotive()


def _target(reader: Reader, value: Any, key: str, scene: Scene) -> tuple[float, float, float] | str:
    if isinstance(value, Sequence) and not isinstance(value, str):
        return reader.vector(value, key, "x, y, z [m]")
    names = scene.point_names()
    if value not in names:
        points = ", ".join(names) or "none in this scene"
        reader.problem(key, repr(value), f"x, y, z [m] or a point of the scene: {points}")
    return str(value)
