"""Module files: read, checked, and put together to the catalogue of a family."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from gaitforge.errors import InputError, Problem
from gaitforge.robot.geometry import Array, Inertia, Shape, inertia_defect, inertia_of_shapes, pose
from gaitforge.robot.limbs import Foot
from gaitforge.robot.module import GENDERS, JOINT_TYPES, KINDS, Body, Module, ModuleJoint, Port
from gaitforge.robot.read import Section, check_format, load_yaml

_KEYS = (
    "format", "name", "kind", "source", "parameters", "bodies", "joint", "ports", "foot", "frames", "mirror",
)  # fmt: skip


def load_module(path: Path, values: Mapping[str, float] | None = None) -> Module:
    """The module in a YAML file, with parameter values; InputError with every problem of the file."""
    top = Section(_cached_yaml(path, path.stat().st_mtime_ns), str(path))
    top.only(*_KEYS)
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
    kinds: dict[str, Callable[[Section], tuple[tuple[float, ...], str]]] = {
        "box": _box, "cylinder": _cylinder, "sphere": _sphere, "mesh": _mesh,
    }  # fmt: skip
    s.only(*kinds, "xyz", "rpy", "steps", "mass", "color", "collision", "visual")
    given = [k for k in kinds if k in s]
    if len(given) != 1:
        s.problem("", ", ".join(given) or "no shape", "one of " + ", ".join(kinds))
        return Shape("sphere", (0.0,))
    size, file = kinds[given[0]](s.child(given[0]))
    return Shape(
        given[0],  # type: ignore[arg-type]
        size,
        _place(s),
        file,
        s.vector("color", 4, "–") if "color" in s else None,
        s.number("mass", "kg", above=0.0) if "mass" in s else None,
        s.flag("collision", True),
        s.flag("visual", True),
    )


def _box(s: Section) -> tuple[tuple[float, ...], str]:
    s.only("size")
    size = s.vector("size", 3, "m")
    if min(size) <= 0.0:
        s.problem("size", repr(s.data.get("size")), "edge lengths > 0 [m]")
    return size, ""


def _cylinder(s: Section) -> tuple[tuple[float, ...], str]:
    s.only("radius", "length")
    return (s.number("radius", "m", above=0.0), s.number("length", "m", above=0.0)), ""


def _sphere(s: Section) -> tuple[tuple[float, ...], str]:
    s.only("radius")
    return (s.number("radius", "m", above=0.0),), ""


def _mesh(s: Section) -> tuple[tuple[float, ...], str]:
    s.only("file", "scale")
    path = (Path(s.file).parent / s.text("file")).resolve()
    if not path.is_file():
        s.problem("file", repr(s.data.get("file")), "a mesh file, relative to the module's file")
    return s.vector("scale", 3, "–", (1.0, 1.0, 1.0)), str(path)


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
    endless = kind == "continuous"
    lower = s.number("lower", "rad", -math.pi if endless else None)
    upper = s.number("upper", "rad", math.pi if endless else None)
    if lower >= upper:
        s.problem("lower", f"{lower:g} (upper is {upper:g})", "lower < upper [rad]")
    return ModuleJoint(
        kind,
        s.text("parent", names),
        s.text("child", names),
        _place(s),
        _axis(s),
        lower,
        upper,
        s.number("effort", "N m", above=0.0),
        s.number("velocity", "rad/s", above=0.0),
        s.number("damping", "N m s/rad", 0.0, least=0.0),
        s.number("friction", "N m", 0.0, least=0.0),
    )


def _axis(s: Section) -> tuple[float, float, float]:
    x, y, z = s.vector("axis", 3, "–")
    if abs(math.hypot(x, y, z) - 1.0) > 1e-6:
        s.problem("axis", f"a length of {math.hypot(x, y, z):g}", "a unit vector")
    return x, y, z


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
