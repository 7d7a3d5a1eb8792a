"""A robot with a load in its grasp, seen as one robot: what the planner works with while it carries."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitforge.robot.model import RobotModel

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Load:
    """A box that does not move in the body frame while it is carried."""

    name: str
    mass: float
    """[kg]"""
    size: tuple[float, float, float]
    """[m] full edge lengths"""
    pose: tuple[float, float, float, float, float, float]
    """x, y, z [m] of its centre, roll, pitch, yaw [rad], in base_link"""


def with_load(robot: RobotModel, load: Load, postures: Mapping[str, Array]) -> RobotModel:
    """The robot with the load as part of its base, and the limbs that hold it (name → joints [rad]) as they hold it.

    Carrying limbs keep their joints while the robot walks: load, limbs and body are one closed chain that
    does not move in itself, so mass, centre of mass and inverse dynamics are those of this robot.
    """
    held = np.array(robot.nominal.held_posture, dtype=float)
    for name, joints in postures.items():
        held[robot.joint_indices(robot.limb(name))] = joints
    nominal = replace(robot.nominal, held_posture=held)
    return replace(robot, urdf=_urdf_with(robot, load), nominal=nominal)


def _urdf_with(robot: RobotModel, load: Load) -> str:
    tree = ET.fromstring(robot.urdf)
    name = f"load_{load.name}"
    link = ET.SubElement(tree, "link", {"name": name})
    inertial = ET.SubElement(link, "inertial")
    ET.SubElement(inertial, "mass", {"value": repr(load.mass)})
    x, y, z = (edge**2 for edge in load.size)
    moments = {"ixx": y + z, "iyy": x + z, "izz": x + y, "ixy": 0.0, "ixz": 0.0, "iyz": 0.0}
    ET.SubElement(inertial, "inertia", {key: repr(load.mass / 12.0 * value) for key, value in moments.items()})
    joint = ET.SubElement(tree, "joint", {"name": f"{name}_joint", "type": "fixed"})
    xyz, rpy = (" ".join(repr(float(v)) for v in part) for part in (load.pose[:3], load.pose[3:]))
    ET.SubElement(joint, "origin", {"xyz": xyz, "rpy": rpy})
    ET.SubElement(joint, "parent", {"link": robot.base_link})
    ET.SubElement(joint, "child", {"link": name})
    return ET.tostring(tree, encoding="unicode")
