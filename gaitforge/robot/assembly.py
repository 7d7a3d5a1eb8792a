"""Assemblies: which modules are bolted where, as frozen values read from ``robot.yaml``."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from gaitforge.errors import InputError, Problem
from gaitforge.resources import module_dirs
from gaitforge.robot.limbs import Foot
from gaitforge.robot.module import Module, is_mirror_image
from gaitforge.robot.module_read import Catalogue, catalogue
from gaitforge.robot.read import Section

LIMB_NAME = re.compile(r"[LRM][1-9][0-9]*")
_RESERVED = ("module", "clock", "lower", "upper", "port")


@dataclass(frozen=True, eq=False)
class Part:
    """One module in a chain, with what the assembly says about it."""

    module: Module
    key: str
    """Where it stands in the file, for messages."""
    clock: float = 0.0
    """Turn about the port it is bolted on [rad]."""
    port: str = "out"
    """Port of this part that the next one is bolted on."""
    lower: float | None = None
    """[rad] narrower joint limits than the module's."""
    upper: float | None = None


@dataclass(frozen=True, eq=False)
class Mount:
    """One limb: a chain of parts on a port of the chassis, and the tool beside its foot."""

    limb: str
    port: str
    chain: tuple[Part, ...]
    tool: tuple[Part, ...] = ()
    mirrored: bool = False
    key: str = ""


@dataclass(frozen=True, eq=False)
class GivenFoot:
    """A foot that the user names, which overrules recognition."""

    foot: Foot
    limb: str = ""
    """Name of the limb; empty: from its place."""
    side: str = ""


@dataclass(frozen=True, eq=False)
class Assembly:
    """A robot as its ``robot.yaml`` describes it."""

    name: str
    file: str
    chassis: Module
    mounts: tuple[Mount, ...]
    feet: tuple[GivenFoot, ...] = ()
    nominal: Section = field(default_factory=lambda: Section({}, ""))


def read_assembly(top: Section, name: str) -> Assembly:
    """The assembly in a file whose format was checked; InputError with all its problems."""
    top.only("format", "name", "family", "chassis", "limbs", "tools", "feet", "nominal")
    modules = _family(top)
    shop = _Shop(modules, top)
    chassis = shop.part(top.data.get("chassis"), "chassis")
    mounts = _mounts(top, shop)
    if not mounts:
        top.problem("limbs", "no mounted limb", "at least one limb with mounts: {L1: a port of the chassis, …}")
    mounts = _with_tools(top, shop, mounts)
    feet = read_feet(top)
    top.raise_problems()
    assert chassis is not None
    if chassis.module.kind != "chassis":
        raise InputError(Problem(top.file, "chassis", f"a {chassis.module.kind}", "a module of kind chassis"))
    return Assembly(top.text("name", default=name), top.file, chassis.module, tuple(mounts), feet, top.child("nominal"))


def _family(top: Section) -> Catalogue:
    families = module_dirs()
    beside = Path(top.file).resolve().parent / "modules"
    if "family" not in top and beside.is_dir():
        return catalogue(beside)
    name = top.text("family", families)
    top.raise_problems()
    return catalogue(families[name])


class _Shop:
    """Fetches modules for the parts of an assembly and notes what is wrong with the asking."""

    def __init__(self, modules: Catalogue, top: Section) -> None:
        self.modules, self.top = modules, top

    def part(self, raw: Any, key: str, mirrored: bool = False) -> Part | None:
        s = Section({"module": raw} if isinstance(raw, str) else raw, self.top.file, key, self.top.problems)
        name = s.text("module")
        values = {k: s.number(k) for k in s.data if k not in _RESERVED}
        clock = s.number("clock", "rad", 0.0)
        lower = s.number("lower", "rad") if "lower" in s else None
        upper = s.number("upper", "rad") if "upper" in s else None
        try:
            module = self.modules.module(name, values, (self.top.file, key))
            if mirrored:
                return self._mirrored(module, key, clock, s.text("port", default="out"), lower, upper)
        except InputError as error:
            self.top.problems.extend(p for p in error.problems if p not in self.top.problems)
            return None
        part = Part(module, s.key, clock, s.text("port", default="out"), lower, upper)
        self._check_limits(s, part)
        return part

    def _mirrored(
        self, module: Module, key: str, clock: float, port: str,
        lower: float | None, upper: float | None,
    ) -> Part:  # fmt: skip
        """The part on the other side of the body: x–z plane mirrored, so turns about x and z change sign.

        A module that is the same hardware on both sides stays; a handed one names its counterpart.
        """
        flipped = {k: -v if k in module.handed else v for k, v in module.parameters.items()}
        other = self.modules.module(module.mirror or module.name, flipped, (self.top.file, key))
        if not is_mirror_image(module, other):
            expected = f"a module that is its own mirror image, or names its counterpart (mirror: in {module.file})"
            self.top.problem(key, f"{module.name} in a mirrored limb", expected)
        if module.joint is not None and abs(module.joint.axis[1]) < 0.5:
            lower, upper = (None if upper is None else -upper), (None if lower is None else -lower)
        return Part(other, key, -clock, port, lower, upper)

    def _check_limits(self, s: Section, part: Part) -> None:
        joint = part.module.joint
        if joint is None:
            if part.lower is not None or part.upper is not None:
                s.problem("lower" if part.lower is not None else "upper", "a limit", "none: the module has no joint")
            return
        lower = joint.lower if part.lower is None else part.lower
        upper = joint.upper if part.upper is None else part.upper
        if lower >= upper:
            s.problem("lower", f"{lower:g} (upper is {upper:g})", "lower < upper [rad]")
        if joint.type == "revolute" and (lower < joint.lower - 1e-9 or upper > joint.upper + 1e-9):
            s.problem("lower", f"{lower:g} … {upper:g}", f"within the module's {joint.lower:g} … {joint.upper:g} [rad]")


def _mounts(top: Section, shop: _Shop) -> list[Mount]:
    mounts: list[Mount] = []
    for name, s in top.children("limbs").items():
        s.only("chain", "mounts", "mirrored")
        chain, mirrored = s.data.get("chain"), s.data.get("mirrored", [])
        ports = s.child("mounts")
        if not isinstance(chain, list) or not chain:
            s.problem("chain", repr(chain), "a list of modules, from the chassis outward")
            continue
        if not isinstance(mirrored, list) or any(x not in ports for x in mirrored):
            s.problem("mirrored", repr(mirrored), "a list of limbs from mounts: " + ", ".join(ports.data))
            mirrored = []
        for limb in ports.data:
            _check_name(ports, limb, [m.limb for m in mounts])
            parts = [shop.part(raw, f"limbs.{name}.chain[{i}]", limb in mirrored) for i, raw in enumerate(chain)]
            whole = tuple(p for p in parts if p is not None)
            mounts.append(Mount(limb, ports.text(limb), whole, (), limb in mirrored, ports.at(limb)))
    top.problems[:] = dict.fromkeys(top.problems)  # a chain is read once for each limb that it is mounted as
    return mounts


def _check_name(ports: Section, limb: str, taken: list[str]) -> None:
    if not LIMB_NAME.fullmatch(limb):
        ports.problem(limb, repr(limb), "a limb name: L1, L2, …, R1, …, or M1, … on the midline")
    if limb in taken:
        ports.problem(limb, f"the limb {limb} again", "each limb once")


def _with_tools(top: Section, shop: _Shop, mounts: list[Mount]) -> list[Mount]:
    tools = top.child("tools")
    names = [m.limb for m in mounts]
    chains: dict[str, tuple[Part, ...]] = {}
    for limb, raw in tools.data.items():
        if limb not in names:
            tools.problem(limb, f"the limb {limb!r}", "one of " + ", ".join(names))
        key = tools.at(limb)
        parts = [shop.part(x, f"{key}[{i}]" if isinstance(raw, list) else key) for i, x in enumerate(_as_list(raw))]
        chains[limb] = tuple(p for p in parts if p is not None)
        if len(parts) == len(chains[limb]) and chains[limb][-1].module.kind not in ("gripper", "camera"):
            tools.problem(limb, f"a {chains[limb][-1].module.kind} at the end", "a gripper or a camera")
    return [Mount(m.limb, m.port, m.chain, chains.get(m.limb, ()), m.mirrored, m.key) for m in mounts]


def _as_list(raw: Any) -> list[Any]:
    return raw if isinstance(raw, list) and raw else [raw]


def read_feet(top: Section) -> tuple[GivenFoot, ...]:
    """The ``feet:`` list of an assembly or of a file beside a URDF."""
    feet = []
    for s in top.listed("feet"):
        s.only("link", "offset", "radius", "limb", "side")
        x, y, z = s.vector("offset", 3, "m", (0.0, 0.0, 0.0))
        foot = Foot(s.text("link"), (x, y, z), s.number("radius", "m", above=0.0))
        limb = s.text("limb", default="")
        if limb and not LIMB_NAME.fullmatch(limb):
            s.problem("limb", repr(limb), "L1, …, R1, … or M1, …")
        side = s.text("side", ("left", "right", "middle")) if "side" in s else ""
        feet.append(GivenFoot(foot, limb, side))
    return tuple(feet)
