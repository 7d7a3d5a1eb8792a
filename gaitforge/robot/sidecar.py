"""A plain URDF as a robot: read, checked, recognised; ``feet:`` and ``nominal:`` in a YAML beside it overrule."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from gaitforge.errors import InputError, Problem
from gaitforge.robot.assembly import GivenFoot, read_feet
from gaitforge.robot.feet import find_feet
from gaitforge.robot.lint import lint, lint_structure, refuse
from gaitforge.robot.read import Section
from gaitforge.robot.read_urdf import read_urdf
from gaitforge.robot.tree import RigidTree, rigid_groups


@dataclass(frozen=True, eq=False)
class Plain:
    """A URDF, one link per rigid group, with its feet and what was noticed."""

    tree: RigidTree
    feet: tuple[GivenFoot, ...]
    warnings: tuple[str, ...]


def urdf_path(top: Section) -> Path:
    """The file that ``urdf:`` names, relative to the YAML; InputError when it is not there."""
    top.only("format", "name", "urdf", "joints", "feet", "nominal")
    path = Path(os.path.expanduser(top.text("urdf")))
    path = path if path.is_absolute() else Path(top.file).resolve().parent / path
    if not path.is_file():
        top.problem("urdf", repr(top.data.get("urdf")), "a URDF file, relative to this file")
    top.raise_problems()
    return path


def read_plain(path: Path, top: Section) -> Plain:
    """Read a URDF and what a YAML says about it.

    Raises InputError with every fatal finding of the lint, and when no foot is recognised.
    """
    raw, notes = read_urdf(path)
    structure = lint_structure(raw)
    refuse(structure, str(path))
    tree = _with_limits(rigid_groups(raw), top)
    findings = (*structure, *lint(tree))
    refuse(findings, str(path))
    given = _on_groups(tree, read_feet(top))
    top.raise_problems()
    found = find_feet(tree)
    feet = given or found.feet
    if not feet:
        notes_text = "no foot: " + ("; ".join(found.notes) or "no terminal link has contact geometry")
        expected = "feet: a list of {link, offset, radius} in a robot.yaml beside the URDF"
        raise InputError(Problem(str(path), "feet", notes_text, expected))
    warnings = (*notes, *(str(f) for f in findings if not f.fatal), *(() if given else found.notes))
    return Plain(replace(tree, name=top.text("name", default=tree.name)), tuple(feet), warnings)


def _with_limits(tree: RigidTree, top: Section) -> RigidTree:
    """Limits that the YAML gives for joints of the URDF: ``joints: {name: {lower, upper, effort, velocity}}``."""
    given = top.children("joints")
    names = [j.name for j in tree.joints]
    for name, s in given.items():
        s.only("lower", "upper", "effort", "velocity")
        if name not in names and name != "all":
            s.problem("", f"the joint {name!r}", "all, or one of " + ", ".join(names))
    joints = []
    for joint in tree.joints:
        for key in ("all", joint.name):
            if key in given:
                s = given[key]
                joint = replace(
                    joint,
                    lower=s.number("lower", "rad", joint.lower),
                    upper=s.number("upper", "rad", joint.upper),
                    effort=s.number("effort", "N m", joint.effort),
                    velocity=s.number("velocity", "rad/s", joint.velocity),
                )
        joints.append(joint)
    return replace(tree, joints=tuple(joints))


def _on_groups(tree: RigidTree, feet: Sequence[GivenFoot]) -> tuple[GivenFoot, ...]:
    """Feet given on a link that was merged into another one, moved to that one."""
    home = {f.name: (x.name, f.T) for x in tree.links for f in x.frames}
    out = []
    for given in feet:
        link, T = home.get(given.foot.link, (given.foot.link, None))
        if T is not None:
            x, y, z = (float(v) for v in T[:3, :3] @ given.foot.offset + T[:3, 3])
            given = replace(given, foot=replace(given.foot, link=link, offset=(x, y, z)))
        out.append(given)
    return tuple(out)
