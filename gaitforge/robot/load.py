"""`load_robot`: from a name, an assembly YAML or a URDF file to a `RobotModel`."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from gaitforge.errors import InputError, Problem
from gaitforge.resources import robot_files
from gaitforge.robot.assembly import Assembly, GivenFoot, read_assembly
from gaitforge.robot.build import BASE, Built, build
from gaitforge.robot.capsules import limb_capsules, trunk_boxes
from gaitforge.robot.limbs import Limb, ToolMount
from gaitforge.robot.lint import lint, refuse
from gaitforge.robot.model import RobotModel
from gaitforge.robot.nominal import read_nominal
from gaitforge.robot.read import Section, check_format, load_yaml
from gaitforge.robot.recognize import recognize
from gaitforge.robot.sidecar import read_plain, urdf_path
from gaitforge.robot.tree import RigidTree
from gaitforge.robot.urdf import urdf_text


def load_robot(robot: str | os.PathLike[str]) -> RobotModel:
    """The robot called by a name (``hexapod``), by the path of an assembly YAML, or by the path of a URDF.

    Raises InputError with every problem found: unknown names list the robots there are.
    """
    path = _find(robot)
    if path.suffix == ".urdf":
        return _from_urdf(path, Section({}, str(path)))
    top = Section(load_yaml(path), str(path))
    check_format(top)
    if "urdf" in top:
        return _from_urdf(urdf_path(top), top)
    return _from_assembly(read_assembly(top, _name(path)), top)


def _find(robot: str | os.PathLike[str]) -> Path:
    files = robot_files()
    if isinstance(robot, str) and robot in files:
        return files[robot]
    path = Path(robot)
    if path.is_file():
        return path
    if path.is_dir() and (path / "robot.yaml").is_file():
        return path / "robot.yaml"
    expected = "one of " + ", ".join(files) + ", or the path of an assembly YAML or a URDF"
    raise InputError(Problem("robot", "robot", repr(os.fspath(robot)), expected))


def _name(path: Path) -> str:
    return path.resolve().parent.name if path.name == "robot.yaml" else path.stem


def _from_assembly(assembly: Assembly, top: Section) -> RobotModel:
    built = build(assembly)
    findings = lint(built.tree)
    refuse(findings, assembly.file)
    tools = {m.limb: tuple(t.name for t in built.tools if t.limb == m.limb) for m in assembly.mounts}
    limbs = recognize(built.tree, _feet(assembly, built), assembly.file, tools)
    return _model(built.tree, limbs, top, built, tuple(str(f) for f in findings))


def _from_urdf(path: Path, top: Section) -> RobotModel:
    plain = read_plain(path, top)
    limbs = recognize(plain.tree, plain.feet, top.file)
    return _model(plain.tree, limbs, top, None, plain.warnings)


def _feet(assembly: Assembly, built: Built) -> list[GivenFoot]:
    """The user's feet where given, else the feet of the foot modules; every limb has one."""
    given = {g.foot.link: g for g in assembly.feet}
    feet = list(given.values())
    for mount in assembly.mounts:
        own = [g for g in feet if g.limb == mount.limb or g.foot.link.startswith(f"{mount.limb}_")]
        if own:
            continue
        if mount.limb not in built.feet:
            found = f"a chain that ends in the {mount.chain[-1].module.kind} {mount.chain[-1].module.name}"
            expected = "a foot module at its end, or an entry in feet: (link, offset, radius)"
            raise InputError(Problem(assembly.file, mount.key, found, expected))
        feet.append(GivenFoot(built.feet[mount.limb], mount.limb))
    return feet


def _model(
    tree: RigidTree, limbs: Sequence[Limb], top: Section, built: Built | None, warnings: tuple[str, ...] = ()
) -> RobotModel:
    names = joint_order(tree, limbs)
    nominal = read_nominal(top.child("nominal"), tree, limbs, names)
    top.raise_problems()
    joints = {j.name: j for j in tree.joints}
    return RobotModel(
        name=tree.name,
        urdf=urdf_text(tree),
        limbs=tuple(limbs),
        joint_names=names,
        lower=np.array([joints[n].lower for n in names]),
        upper=np.array([joints[n].upper for n in names]),
        velocity=np.array([joints[n].velocity for n in names]),
        effort=np.array([joints[n].effort for n in names]),
        nominal=nominal,
        tools=tuple(ToolMount(t.name, t.kind, t.limb, t.link, t.T, t.joints) for t in built.tools) if built else (),  # type: ignore[arg-type]
        capsules=limb_capsules(tree, limbs),
        trunk=trunk_boxes(tree),
        base_link=BASE if built else tree.root,
        modules=built.modules if built else len(names),
        warnings=warnings,
    )


def joint_order(tree: RigidTree, limbs: Sequence[Limb]) -> tuple[str, ...]:
    """Joints limb by limb, tool joints after those of their limb, joints of no limb last."""
    mine: Mapping[str, None] = dict.fromkeys(j for x in limbs for j in (*x.joints, *x.tool_joints))
    return tuple(mine) + tuple(j.name for j in tree.joints if j.name not in mine)
