"""The URDF as a viewer wants it: meshes inside the text, and a see-through copy for the plan."""

from __future__ import annotations

import base64
import xml.etree.ElementTree as ET
from pathlib import Path

MESH_TYPES = {
    ".stl": "model/stl",
    ".dae": "model/vnd.collada+xml",
    ".obj": "model/obj",
    ".glb": "model/gltf-binary",
    ".gltf": "model/gltf+json",
}

GHOST_COLOR = (0.1, 0.75, 0.35)
"""red, green, blue of the planned robot."""


def self_contained(urdf: str) -> str:
    """The URDF with every mesh that can be read here inlined as ``data:…;base64``; viewers find no others."""
    robot = ET.fromstring(urdf)
    meshes = [mesh for mesh in robot.iter("mesh") if _local(mesh.get("filename", ""))]
    if not meshes:
        return urdf
    for mesh in meshes:
        path = Path(mesh.attrib["filename"].removeprefix("file://"))
        content = base64.b64encode(path.read_bytes()).decode()
        mesh.set("filename", f"data:{MESH_TYPES[path.suffix.lower()]};base64,{content}")
    return ET.tostring(robot, encoding="unicode")


def ghost(urdf: str, alpha: float = 0.3) -> str:
    """The URDF with every visual in one see-through colour; link names stay, `framePrefix` adds ``plan/``."""
    robot = ET.fromstring(urdf)
    for material in robot.findall("material"):
        robot.remove(material)
    for visual in robot.iter("visual"):
        for material in visual.findall("material"):
            visual.remove(material)
        material = ET.SubElement(visual, "material", name="plan")
        ET.SubElement(material, "color", rgba=" ".join(f"{c:g}" for c in (*GHOST_COLOR, alpha)))
    return ET.tostring(robot, encoding="unicode")


def _local(filename: str) -> bool:
    path = Path(filename.removeprefix("file://"))
    return "://" not in str(filename.removeprefix("file://")) and path.suffix.lower() in MESH_TYPES and path.is_file()
