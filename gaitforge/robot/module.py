"""Modules: the hardware a robot is bolted together from, as frozen values read from YAML."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from gaitforge.errors import InputError, Problem
from gaitforge.robot.geometry import Array, Inertia, Shape, inertia_defect, inertia_of_shapes, pose
from gaitforge.robot.limbs import Foot
from gaitforge.robot.read import Section, check_format, load_yaml

KINDS = ("chassis", "actuator", "bracket", "tube", "foot", "gripper", "camera")
GENDERS = ("male", "female", "neutral")
JOINT_TYPES = ("revolute", "continuous")


@dataclass(frozen=True, eq=False)
class Port:
    """Where another module is bolted on: z points out of the module (of its ``in`` port: into it)."""

    name: str
    body: str
    T: Array
    """(4, 4) in the body frame"""
    type: str
    """Mechanical interface, e.g. ``sea``; only equal types fit."""
    gender: str
    """male · female · neutral; opposite ones fit, and neutral with neutral."""
    clocking: tuple[float, ...] | None
    """Allowed turns about z [rad]; None: any."""

    def allows(self, angle: float) -> bool:
        """May the other module be turned by `angle` [rad]?"""
        if self.clocking is None:
            return True
        return any(abs(math.remainder(angle - a, 2.0 * math.pi)) < 1e-4 for a in self.clocking)


@dataclass(frozen=True, eq=False)
class ModuleJoint:
    """The actuated joint of a module: between its first body and the body `child`."""

    type: str
    parent: str
    child: str
    T: Array
    """(4, 4) joint (and child body) frame in the parent body's"""
    axis: tuple[float, float, float]
    lower: float
    """[rad]"""
    upper: float
    effort: float
    """[N m]"""
    velocity: float
    """[rad/s]"""
    damping: float = 0.0
    """[N m s/rad]"""
    friction: float = 0.0
    """[N m]"""


@dataclass(frozen=True, eq=False)
class Body:
    """One rigid part of a module."""

    name: str
    inertia: Inertia
    shapes: tuple[Shape, ...]


@dataclass(frozen=True, eq=False)
class Module:
    """One piece of hardware, with its parameters (a tube's length, …) put in."""

    name: str
    kind: str
    source: str
    file: str
    bodies: tuple[Body, ...]
    ports: Mapping[str, Port]
    joint: ModuleJoint | None = None
    foot: Foot | None = None
    """`foot.link` is the body."""
    frames: Mapping[str, tuple[str, Array]] = field(default_factory=dict)
    """Named frames, e.g. a camera's ``optical``: body, (4, 4)."""
    mirror: str = ""
    """Module that takes its place in a mirrored limb; empty: itself."""
    parameters: Mapping[str, float] = field(default_factory=dict)
    handed: tuple[str, ...] = ()
    """Parameters that change sign in a mirrored limb, e.g. a twist."""


def load_module(path: Path, values: Mapping[str, float] | None = None) -> Module:
    """The module in a YAML file, with parameter values; InputError with every problem of the file."""
    top = Section(_cached_yaml(path, path.stat().st_mtime_ns), str(path))
    top.only("format", "name", "kind", "source", "parameters", "bodies", "joint", "ports", "foot", "frames", "mirror")
    check_format(top)
    top.values = _parameters(top, values or {})
    bodies = tuple(_body(name, s) for name, s in top.children("bodies").items())
    if not bodies:
        top.problem("bodies", "nothing", "at least one body")
    module = Module(
        name=top.text("name"),
        kind=top.text("kind", KINDS),
        source=top.text("source"),
        file=str(path),
        bodies=bodies,
        ports={n: _port(n, s, bodies) for n, s in top.children("ports").items()},
        joint=_joint(top.child("joint"), bodies) if "joint" in top else None,
        foot=_foot(top.child("foot"), bodies) if "foot" in top else None,
        frames={n: _frame(s, bodies) for n, s in top.children("frames").items()},
        mirror=top.text("mirror", default=""),
        parameters=top.values,
        handed=tuple(n for n, s in top.children("parameters").items() if s.flag("handed", False)),
    )
    _check_whole(top, module)
    top.raise_problems()
    return module


@lru_cache(maxsize=256)
def _cached_yaml(path: Path, _modified: int) -> dict[str, Any]:
    return load_yaml(path)


def _parameters(top: Section, given: Mapping[str, float]) -> dict[str, float]:
    values: dict[str, float] = {}
    for name, s in top.children("parameters").items():
        s.only("default", "lower", "upper", "handed")
        lower, upper = s.number("lower", default=-math.inf), s.number("upper", default=math.inf)
        values[name] = given.get(name, s.number("default"))
        if not lower <= values[name] <= upper:
            s.problem("", f"{values[name]:g}", f"between {lower:g} and {upper:g}")
    for name in sorted(set(given) - set(values)):
        expected = "one of " + ", ".join(values) if values else "no parameters: this module has none"
        top.problem("parameters", f"a value for {name!r}", expected)
    return values


def _place(s: Section) -> Array:
    """A pose: ``xyz`` [m] and ``rpy`` [rad], or ``steps``, a list of such poses one after the other."""
    if "steps" in s:
        T = np.eye(4)
        for step in s.listed("steps"):
            step.only("xyz", "rpy")
            T = T @ _place(step)
        return T
    return pose(s.vector("xyz", 3, "m", (0.0, 0.0, 0.0)), s.vector("rpy", 3, "rad", (0.0, 0.0, 0.0)))


def _body_name(s: Section, bodies: tuple[Body, ...]) -> str:
    names = [b.name for b in bodies]
    return s.text("body", names, default=names[0] if len(names) == 1 else None)


def _body(name: str, s: Section) -> Body:
    s.only("mass", "com", "inertia", "shapes")
    shapes = tuple(_shape(x) for x in s.listed("shapes"))
    own = [x.mass for x in shapes if x.mass is not None]
    mass = None if own and "mass" not in s else s.number("mass", "kg", least=0.0)
    solid = inertia_of_shapes(shapes, mass)
    if mass is not None and mass > 0.0 and solid.mass == 0.0 and not {"com", "inertia"} <= s.data.keys():
        s.problem("inertia", "nothing", "com and inertia, or shapes with a volume that the mass is spread over")
    com = np.array(s.vector("com", 3, "m", tuple(solid.com)))
    matrix = _inertia_matrix(s.child("inertia")) if "inertia" in s else solid.matrix
    inertia = Inertia(solid.mass if mass is None else mass, com, matrix)
    defect = inertia_defect(inertia.matrix) if inertia.mass > 0.0 else None
    if defect is not None and not s.problems:
        s.problem("inertia", defect, "a positive definite inertia whose principal moments obey a + b ≥ c")
    return Body(name, inertia, shapes)


def _inertia_matrix(s: Section) -> Array:
    s.only("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    xx, yy, zz = (s.number(k, "kg m²") for k in ("ixx", "iyy", "izz"))
    xy, xz, yz = (s.number(k, "kg m²", 0.0) for k in ("ixy", "ixz", "iyz"))
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _shape(s: Section) -> Shape:
    kinds = ("box", "cylinder", "sphere", "mesh")
    s.only(*kinds, "xyz", "rpy", "steps", "mass", "color", "collision", "visual")
    given = [k for k in kinds if k in s]
    if len(given) != 1:
        s.problem("", ", ".join(given) or "no shape", "one of " + ", ".join(kinds))
        return Shape("sphere", (0.0,))
    inner, file = s.child(given[0]), ""
    if given[0] == "box":
        inner.only("size")
        size = inner.vector("size", 3, "m")
    elif given[0] == "cylinder":
        inner.only("radius", "length")
        size = (inner.number("radius", "m", above=0.0), inner.number("length", "m", above=0.0))
    elif given[0] == "sphere":
        inner.only("radius")
        size = (inner.number("radius", "m", above=0.0),)
    else:
        inner.only("file", "scale")
        size, file = inner.vector("scale", 3, "–", (1.0, 1.0, 1.0)), inner.text("file")
        file = str((Path(s.file).parent / file).resolve())
        if not Path(file).is_file():
            inner.problem("file", repr(inner.data.get("file")), "a mesh file, relative to the module's file")
    if any(x <= 0.0 for x in size):
        inner.problem("", repr(inner.data), "sizes > 0 [m]")
    color = s.vector("color", 4, "–") if "color" in s else None
    mass = s.number("mass", "kg", above=0.0) if "mass" in s else None
    return Shape(
        given[0],  # type: ignore[arg-type]
        size,
        _place(s),
        file,
        None if color is None else (color[0], color[1], color[2], color[3]),
        mass,
        s.flag("collision", True),
        s.flag("visual", True),
    )


def _port(name: str, s: Section, bodies: tuple[Body, ...]) -> Port:
    s.only("body", "xyz", "rpy", "steps", "type", "gender", "clocking")
    angles = s.data.get("clocking", [0.0])
    clocking = None
    if angles != "any":
        clocking = s.vector("clocking", len(angles) if isinstance(angles, list) else 1, "rad", (0.0,))
    gender = s.text("gender", GENDERS)
    return Port(name, _body_name(s, bodies), _place(s), s.text("type"), gender, clocking)


def _joint(s: Section, bodies: tuple[Body, ...]) -> ModuleJoint:
    s.only(
        "type", "parent", "child", "xyz", "rpy", "steps", "axis", "lower", "upper", "effort", "velocity",
        "damping", "friction",
    )  # fmt: skip
    names = [b.name for b in bodies]
    kind = s.text("type", JOINT_TYPES)
    turn = math.pi if kind == "continuous" else None
    lower = s.number("lower", "rad", None if turn is None else -turn)
    upper = s.number("upper", "rad", turn)
    if lower >= upper:
        s.problem("lower", f"{lower:g} (upper is {upper:g})", "lower < upper [rad]")
    axis = s.vector("axis", 3, "–")
    if abs(math.hypot(*axis) - 1.0) > 1e-6:
        s.problem("axis", f"a length of {math.hypot(*axis):g}", "a unit vector")
    return ModuleJoint(
        kind,
        s.text("parent", names),
        s.text("child", names),
        _place(s),
        (axis[0], axis[1], axis[2]),
        lower,
        upper,
        s.number("effort", "N m", above=0.0),
        s.number("velocity", "rad/s", above=0.0),
        s.number("damping", "N m s/rad", 0.0, least=0.0),
        s.number("friction", "N m", 0.0, least=0.0),
    )


def _foot(s: Section, bodies: tuple[Body, ...]) -> Foot:
    s.only("body", "xyz", "radius")
    x, y, z = s.vector("xyz", 3, "m")
    return Foot(_body_name(s, bodies), (x, y, z), s.number("radius", "m", above=0.0))


def _frame(s: Section, bodies: tuple[Body, ...]) -> tuple[str, Array]:
    s.only("body", "xyz", "rpy", "steps")
    return _body_name(s, bodies), _place(s)


def _check_whole(top: Section, module: Module) -> None:
    """What one key alone cannot tell."""
    if module.kind == "actuator" and module.joint is None:
        top.problem("joint", "nothing", "a joint: the module is an actuator")
    if module.kind not in ("actuator", "gripper", "") and module.joint is not None:
        top.problem("joint", f"a joint in a {module.kind}", "kind: actuator or gripper")
    if module.kind == "camera" and "optical" not in module.frames:
        top.problem("frames", "no optical frame", "optical: z ahead, x right, y down")
    if module.kind == "foot" and module.foot is None:
        top.problem("foot", "nothing", "a foot sphere: body, xyz, radius")
    if len(module.bodies) > (1 if module.joint is None else 2):
        top.problem("bodies", f"{len(module.bodies)} bodies", "one body, or two with a joint between them")
    if module.joint is not None and module.joint.parent == module.joint.child:
        top.problem("joint.child", repr(module.joint.child), "another body than the parent")
    if module.kind != "chassis" and "in" not in module.ports:
        top.problem("ports", ", ".join(module.ports) or "nothing", "a port called 'in'")


@dataclass(frozen=True, eq=False)
class Catalogue:
    """The modules of one family, read when they are asked for."""

    family: str
    files: Mapping[str, Path]

    def module(self, name: str, values: Mapping[str, float], asked: tuple[str, str]) -> Module:
        """The module of that name; `asked` is the file and key that ask for it, for the message."""
        if name not in self.files:
            expected = f"a module of {self.family}: " + ", ".join(self.files)
            raise InputError(Problem(asked[0], asked[1], f"the unknown module {name!r}", expected))
        return load_module(self.files[name], values)


def catalogue(folder: Path) -> Catalogue:
    """All modules in ``robots/modules/<family>``: one file each, named after its module."""
    return Catalogue(folder.name, {p.stem: p for p in sorted(folder.glob("*.yaml"))})
