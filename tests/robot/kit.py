"""Robots written to a folder for a test, with something changed in them."""

from __future__ import annotations

from pathlib import Path

from gaitforge.errors import InputError, Problem
from gaitforge.resources import module_dirs, robot_files
from gaitforge.robot.load import load_robot


def shipped(robot: str) -> str:
    """The text of a shipped robot.yaml."""
    return robot_files()[robot].read_text(encoding="utf-8")


def changed(text: str, *pairs: tuple[str, str]) -> str:
    """The text with replacements, each of which must hit something."""
    for old, new in pairs:
        assert old in text, old
        text = text.replace(old, new)
    return text


def write_robot(
    folder: Path,
    robot: str = "hexapod",
    *pairs: tuple[str, str],
    modules: dict[str, list[tuple[str, str]]] | None = None,
) -> Path:
    """A shipped robot with its modules in `folder`, some lines of its YAML or of its modules changed."""
    text = shipped(robot)
    family = next(line.split(": ")[1] for line in text.splitlines() if line.startswith("family"))
    (folder / "modules").mkdir(parents=True)
    for file in module_dirs()[family].glob("*.yaml"):
        own = changed(file.read_text(encoding="utf-8"), *(modules or {}).get(file.stem, []))
        (folder / "modules" / file.name).write_text(own, encoding="utf-8")
    path = folder / "robot.yaml"
    path.write_text(changed(text, (f"family: {family}\n", ""), *pairs), encoding="utf-8")
    return path


def problems(path: Path | str) -> tuple[Problem, ...]:
    """What loading the robot complains about."""
    try:
        load_robot(path)
    except InputError as error:
        return error.problems
    raise AssertionError(f"{path} was accepted")
