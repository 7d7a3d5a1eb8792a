"""From an assembly to a tree of rigid links: ports mated, fixed parts merged."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from gaitforge.errors import InputError, Problem
from gaitforge.robot.assembly import Assembly, Mount, Part
from gaitforge.robot.geometry import Array, Inertia, Shape, inverse, merged, pose
from gaitforge.robot.limbs import Foot
from gaitforge.robot.module import Module, Port
from gaitforge.robot.tree import Joint, Link, RigidTree

_OPPOSITE = {"male": "female", "female": "male", "neutral": "neutral"}
BASE = "base_link"


@dataclass(frozen=True, eq=False)
class BuiltTool:
    """A gripper or camera, where it ended up."""

    name: str
    kind: str
    limb: str
    link: str
    T: Array
    """(4, 4) of the tool frame in the link"""
    joints: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Built:
    """The tree, and what the modules say about it."""

    tree: RigidTree
    feet: dict[str, Foot]
    """Limb → its foot module's sphere, `Foot.link` a link of the tree."""
    tools: tuple[BuiltTool, ...]
    modules: int
    """Actuated modules."""


@dataclass(eq=False)
class _Place:
    """Where the next module goes: a port on a link that is being built."""

    link: str
    T: Array
    port: Port
    owner: Module


@dataclass(eq=False)
class _Site:
    """The robot while it is bolted together."""

    file: str
    inertias: dict[str, list[Inertia]] = field(default_factory=lambda: {BASE: []})
    shapes: dict[str, list[Shape]] = field(default_factory=lambda: {BASE: []})
    joints: list[Joint] = field(default_factory=list)
    feet: dict[str, Foot] = field(default_factory=dict)
    tools: list[BuiltTool] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)

    def weld(self, link: str, module: Module, body: str, T: Array) -> None:
        """Make a body of a module part of a link."""
        found = next(b for b in module.bodies if b.name == body)
        self.inertias.setdefault(link, []).append(found.inertia.moved(T))
        self.shapes.setdefault(link, []).extend(s.moved(T) for s in found.shapes)


def build(assembly: Assembly) -> Built:
    """Bolt the assembly together; InputError when ports do not fit or do not exist."""
    site = _Site(assembly.file)
    for body in assembly.chassis.bodies:
        site.weld(BASE, assembly.chassis, body.name, np.eye(4))
    names = Counter(m.tool[-1].module.kind for m in assembly.mounts if m.tool)
    taken: dict[str, str] = {}
    for mount in assembly.mounts:
        port = _port(site, assembly.chassis, mount.port, mount.key)
        if port is None:
            continue
        if mount.port in taken:
            found = f"the port {mount.port}, where {taken[mount.port]} is"
            site.problems.append(Problem(site.file, mount.key, found, "a free port of the chassis"))
        taken[mount.port] = mount.limb
        _limb(site, mount, _Place(BASE, port.T, port, assembly.chassis), names)
    if site.problems:
        raise InputError(dict.fromkeys(site.problems))
    links = tuple(Link(n, merged(site.inertias[n]), tuple(site.shapes[n])) for n in site.inertias)
    return Built(RigidTree(assembly.name, links, tuple(site.joints)), site.feet, tuple(site.tools), len(site.joints))


def _limb(site: _Site, mount: Mount, place: _Place, kinds: Counter[str]) -> None:
    ends = _chain(site, mount.chain, place, mount.limb, [f"{mount.limb}_J", f"{mount.limb}_link"])
    if ends is None or not mount.tool:
        return
    owner = mount.chain[-1].module
    port = _port(site, owner, "tool", f"tools.{mount.limb}")
    if port is None:
        return
    kind = mount.tool[-1].module.kind
    home = _Place(ends[0][port.body], ends[1][port.body] @ port.T, port, owner)
    before = len(site.joints)
    tool_ends = _chain(site, mount.tool, home, mount.limb, [f"{mount.limb}_{kind}", f"{mount.limb}_{kind}_link"])
    if tool_ends is None:
        return
    link, T = _tool_frame(mount.tool[-1].module, *tool_ends)
    name = kind if kinds[kind] == 1 else f"{kind}_{mount.limb}"
    joints = tuple(j.name for j in site.joints[before:])
    site.tools.append(BuiltTool(name, kind, mount.limb, link, T, joints))


def _tool_frame(module: Module, links: dict[str, str], poses: dict[str, Array]) -> tuple[str, Array]:
    """A camera's optical frame, a gripper's ``grip`` frame if it has one, else its last body's frame."""
    wanted = "optical" if module.kind == "camera" else "grip"
    body, T = module.frames.get(wanted, (module.bodies[-1].name, np.eye(4)))
    return links[body], poses[body] @ T


def _chain(
    site: _Site, parts: tuple[Part, ...], place: _Place, limb: str, names: list[str]
) -> tuple[dict[str, str], dict[str, Array]] | None:
    """Bolt parts one after the other; returns body → link and body → pose in its link of the last one."""
    links: dict[str, str] = {}
    poses: dict[str, Array] = {}
    many = sum(p.module.joint is not None for p in parts) > 1 or names[0].endswith("_J")
    count = 0
    for index, part in enumerate(parts):
        entry = part.module.ports["in"]
        if not _fits(site, part, place, entry):
            return None
        T = place.T @ pose(rpy=(0.0, 0.0, part.clock)) @ inverse(entry.T)
        links, poses = {entry.body: place.link}, {entry.body: T}
        site.weld(place.link, part.module, entry.body, T)
        if part.module.joint is not None:
            count += 1
            suffix = str(count) if many else ""
            child = _joint(site, part, place.link, T, names[0] + suffix, names[1] + suffix)
            links[part.module.joint.child], poses[part.module.joint.child] = child, np.eye(4)
        if part.module.foot is not None:
            _set_foot(site, limb, part.module.foot, links, poses)
        if index + 1 < len(parts):
            port = _port(site, part.module, part.port, parts[index + 1].key)
            if port is None:
                return None
            place = _Place(links[port.body], poses[port.body] @ port.T, port, part.module)
    return links, poses


def _joint(site: _Site, part: Part, parent: str, T: Array, name: str, child: str) -> str:
    joint = part.module.joint
    assert joint is not None
    lower = joint.lower if part.lower is None else part.lower
    upper = joint.upper if part.upper is None else part.upper
    origin = T @ joint.T
    rest = (joint.axis, lower, upper, joint.effort, joint.velocity, joint.damping, joint.friction)
    site.joints.append(Joint(name, "revolute", parent, child, origin, *rest))
    site.inertias[child], site.shapes[child] = [], []
    site.weld(child, part.module, joint.child, np.eye(4))
    return child


def _set_foot(site: _Site, limb: str, foot: Foot, links: dict[str, str], poses: dict[str, Array]) -> None:
    T = poses[foot.link]
    x, y, z = T[:3, :3] @ foot.offset + T[:3, 3]
    site.feet[limb] = Foot(links[foot.link], (float(x), float(y), float(z)), foot.radius)


def _port(site: _Site, module: Module, name: str, key: str) -> Port | None:
    port = module.ports.get(name)
    if port is None or name == "in":
        expected = f"a port of {module.name}: " + ", ".join(n for n in module.ports if n != "in")
        site.problems.append(Problem(site.file, key, f"the port {name!r}", expected))
        return None
    return port


def _fits(site: _Site, part: Part, place: _Place, entry: Port) -> bool:
    """Type, gender and clocking of the two ports that meet."""
    out, into = f"{place.owner.name}.{place.port.name}", f"{part.module.name}.in"
    trouble = None
    if place.port.type != entry.type:
        trouble = (f"{into} of type {entry.type}", f"type {place.port.type}, to fit {out}")
    elif _OPPOSITE[place.port.gender] != entry.gender:
        trouble = (f"{into}, {entry.gender}", f"{_OPPOSITE[place.port.gender]}, to fit {out}, {place.port.gender}")
    elif not (place.port.allows(part.clock) and entry.allows(-part.clock)):
        allowed = place.port if not place.port.allows(part.clock) else entry
        angles = ", ".join(f"{a:g}" for a in allowed.clocking or ())
        trouble = (f"clock {part.clock:g} rad ({math.degrees(part.clock):.0f}°)", f"one of {angles} rad")
    if trouble is not None:
        site.problems.append(Problem(site.file, part.key, *trouble))
    return trouble is None
