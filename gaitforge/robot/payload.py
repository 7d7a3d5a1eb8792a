"""Loads: what a robot carries besides itself, and the URDF of a robot that carries it."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitforge.robot.geometry import Inertia, merged
from gaitforge.robot.rotation import matrices

Array = NDArray[np.float64]
BODY = "body"
WATER = 1000.0
"""[kg/m³]"""


@dataclass(frozen=True)
class Load:
    """A rigid load that moves with one body of the robot.

    It counts with its mass at its centre of mass, and with the rotational inertia of a ball of water of
    that mass.  Raises ValueError for a mass that is not positive or a point that has not three coordinates.
    """

    mass: float
    """[kg]"""
    point: tuple[float, float, float]
    """[m] centre of mass in the frame"""
    frame: str = BODY
    """``body`` (base_link), the name of a limb (the link of its foot), or of a tool (its tool frame)"""

    def __post_init__(self) -> None:
        if not (math.isfinite(self.mass) and self.mass > 0.0):
            raise ValueError(f"a load has a mass > 0 [kg], found {self.mass}")
        point = tuple(float(v) for v in self.point)
        if len(point) != 3 or not all(math.isfinite(v) for v in point):
            raise ValueError(f"the point of a load has three coordinates [m], found {self.point}")
        object.__setattr__(self, "point", point)

    @property
    def inertia(self) -> Array:
        """(3, 3) about its centre of mass [kg m²]."""
        radius = (3.0 * self.mass / (4.0 * math.pi * WATER)) ** (1.0 / 3.0)
        return np.asarray(0.4 * self.mass * radius**2 * np.eye(3))

    def as_dict(self) -> dict[str, Any]:
        """For ``summary.json``."""
        return {"mass_kg": self.mass, "point_m": list(self.point), "frame": self.frame}


def laden_urdf(urdf: str, carried: Iterable[tuple[Load, str, Array]]) -> str:
    """A robot's URDF with loads in the inertias of the links that carry them.

    `carried`: each load, the link that carries it, and the load's centre of mass in that link's frame (3,) [m].
    """
    import xml.etree.ElementTree as ET

    root = ET.fromstring(urdf)
    links = {link.get("name"): link for link in root.findall("link")}
    for load, name, point in carried:
        links[name] = _weighed(ET, links[name], Inertia(load.mass, point, load.inertia))
    ET.indent(root)
    return ET.tostring(root, encoding="unicode", xml_declaration=True)


def _weighed(ET: Any, link: Any, load: Inertia) -> Any:
    """The link's element with the load in its inertial."""
    inertial = link.find("inertial")
    own = Inertia() if inertial is None else _read(inertial)
    if inertial is not None:
        link.remove(inertial)
    both = merged((own, load))
    element = ET.Element("inertial")
    ET.SubElement(element, "origin", xyz=" ".join(_text(v) for v in both.com), rpy="0 0 0")
    ET.SubElement(element, "mass", value=_text(both.mass))
    at = {"x": 0, "y": 1, "z": 2}
    keys = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    ET.SubElement(element, "inertia", {key: _text(both.matrix[at[key[1]], at[key[2]]]) for key in keys})
    link.insert(0, element)
    return link


def _text(value: Any) -> str:
    return repr(float(value))


def _read(inertial: Any) -> Inertia:
    """An inertial element in the axes of its link."""

    def numbers(element: Any, key: str) -> Array:
        text = None if element is None else element.get(key)
        return np.array([float(v) for v in text.split()]) if text else np.zeros(3)

    origin, values = inertial.find("origin"), inertial.find("inertia")
    xx, xy, xz, yy, yz, zz = (float(values.get(k, 0.0)) for k in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = matrices(numbers(origin, "rpy")[None])[0], numbers(origin, "xyz")
    matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return Inertia(float(inertial.find("mass").get("value")), np.zeros(3), matrix).moved(T)
