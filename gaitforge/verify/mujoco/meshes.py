"""Meshes in formats that MuJoCo does not read (it reads STL and OBJ), handed over as vertices and faces."""

from __future__ import annotations

from pathlib import Path
from typing import Any

READ = (".stl", ".obj", ".msh")


def hand_over_meshes(spec: Any) -> None:
    """Replace the file of every mesh that MuJoCo would refuse, a Collada file say, by what it holds.

    Raises ValueError for a file that cannot be read.
    """
    for mesh in spec.meshes:
        if not mesh.file or Path(mesh.file).suffix.lower() in READ:
            continue
        mesh.uservert, mesh.userface = _content(mesh.file)
        mesh.file = ""


def _content(file: str) -> tuple[list[float], list[int]]:
    """x, y, z of the vertices and the vertices of the triangles, one after the other."""
    import trimesh

    try:
        found: Any = trimesh.load(file, force="mesh")
    except Exception as error:  # trimesh's readers raise what their format's library raises
        raise ValueError(f"{file}: {type(error).__name__}: {error}") from error
    return found.vertices.reshape(-1).tolist(), found.faces.reshape(-1).tolist()
