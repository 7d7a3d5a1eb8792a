"""The one place that knows where ``conf/`` and ``robots/`` lie: checkout, wheel and user folders."""

from __future__ import annotations

import os
from pathlib import Path

ROBOTS_VARIABLE = "GAITFORGE_ROBOTS"
"""Environment variable: more folders with robots, separated like PATH."""

_PACKAGE = Path(__file__).resolve().parent


def _shipped(name: str) -> Path:
    """A folder that ships with gaitforge: inside the package in a wheel, beside it in a checkout."""
    packaged = _PACKAGE / name
    return packaged if packaged.is_dir() else _PACKAGE.parent / name


def conf_dir() -> Path:
    """The Hydra configuration that ships with gaitforge."""
    return _shipped("conf")


def robot_dirs() -> tuple[Path, ...]:
    """Folders that hold robots, the user's first: GAITFORGE_ROBOTS, ``./robots``, then the shipped ones."""
    named = [Path(p).expanduser() for p in os.environ.get(ROBOTS_VARIABLE, "").split(os.pathsep) if p]
    folders: dict[Path, None] = {}
    for folder in [*named, Path.cwd() / "robots", _shipped("robots")]:
        if folder.is_dir():
            folders.setdefault(folder.resolve())
    return tuple(folders)


def robot_files() -> dict[str, Path]:
    """Robot name → its ``robots/<name>/robot.yaml``, sorted by name; a user's robot hides a shipped one."""
    found: dict[str, Path] = {}
    for folder in robot_dirs():
        for file in sorted(folder.glob("*/robot.yaml")):
            found.setdefault(file.parent.name, file)
    return dict(sorted(found.items()))


def module_dirs() -> dict[str, Path]:
    """Module family → its folder ``robots/modules/<family>``; a user's family hides a shipped one."""
    found: dict[str, Path] = {}
    for folder in robot_dirs():
        for family in sorted(p for p in (folder / "modules").glob("*") if p.is_dir()):
            found.setdefault(family.name, family)
    return dict(sorted(found.items()))
