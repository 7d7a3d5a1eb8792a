"""Imports point down, heavy libraries are loaded late and only where they belong."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

import gaitforge

PACKAGE = Path(gaitforge.__file__).parent
LAYERS = (
    "errors", "resources", "robot", "task", "footfall", "motion", "verify", "record", "report", "pipeline",
    "experiment", "cli",
)  # fmt: skip
HEAVY = {
    "ortools": {"footfall"},
    "casadi": {"robot", "motion"},
    "pinocchio": {"robot", "motion"},
    "pybullet": {"verify"},
    "mujoco": {"verify"},
    "mcap": {"record"},
    "mcap_protobuf": {"record"},
    "matplotlib": {"report", "record"},
    "yourdfpy": {"robot"},
    "hydra": {"cli", "config"},
    "omegaconf": {"cli", "config"},
}
LATE = set(HEAVY) - {"hydra", "omegaconf"}
FILES = sorted(PACKAGE.rglob("*.py"))


def room(file: Path) -> str:
    """The part of the house that a file belongs to."""
    return file.relative_to(PACKAGE).parts[0].removesuffix(".py")


def imports(file: Path) -> Iterator[tuple[str, bool, int]]:
    """(module, at import time, line) of every import; those for type checkers alone are left out."""

    def walk(node: ast.AST, late: bool) -> Iterator[tuple[str, bool, int]]:
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.If) and "TYPE_CHECKING" in ast.dump(child.test):
                continue
            if isinstance(child, ast.Import):
                yield from ((name.name, not late, child.lineno) for name in child.names)
            elif isinstance(child, ast.ImportFrom):
                assert child.level == 0, f"{file}:{child.lineno}: imports are absolute"
                yield child.module or "", not late, child.lineno
                if child.module == "gaitforge":
                    yield from ((f"gaitforge.{name.name}", not late, child.lineno) for name in child.names)
            inside = isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
            yield from walk(child, late or inside)

    yield from walk(ast.parse(file.read_text()), False)


@pytest.mark.parametrize("file", FILES, ids=lambda f: str(f.relative_to(PACKAGE)))
def test_imports_point_down(file: Path) -> None:
    here = room(file)
    if here in ("__init__", "__main__"):
        return
    wrong = []
    for module, _, line in imports(file):
        parts = module.split(".")
        if parts[0] != "gaitforge" or len(parts) == 1 or parts[1] == "__version__":
            continue
        there = parts[1]
        if here == "config":
            allowed = there in ("config", "errors")
        elif there == "config":
            allowed = here == "cli"
        else:
            allowed = there in LAYERS and here in LAYERS and LAYERS.index(there) <= LAYERS.index(here)
        if not allowed:
            wrong.append(f"line {line}: {module}")
    assert wrong == []


@pytest.mark.parametrize("file", FILES, ids=lambda f: str(f.relative_to(PACKAGE)))
def test_heavy_libraries_are_loaded_late_and_where_they_belong(file: Path) -> None:
    wrong = []
    for module, at_import, line in imports(file):
        library = module.split(".")[0]
        if library in HEAVY and room(file) not in HEAVY[library]:
            wrong.append(f"line {line}: {library} outside of {', '.join(sorted(HEAVY[library]))}")
        if library in LATE and at_import:
            wrong.append(f"line {line}: {library} is loaded at import")
    assert wrong == []


def test_every_room_of_the_house_has_its_layer() -> None:
    rooms = {room(file) for file in FILES} - {"__init__", "__main__", "config"}
    assert rooms == set(LAYERS)


@pytest.mark.parametrize("file", FILES, ids=lambda f: str(f.relative_to(PACKAGE)))
def test_no_file_is_longer_than_four_hundred_lines(file: Path) -> None:
    assert len(file.read_text().splitlines()) <= 400


def test_only_the_command_line_prints() -> None:
    printing = [
        str(file.relative_to(PACKAGE))
        for file in FILES
        if room(file) != "cli"
        for node in ast.walk(ast.parse(file.read_text()))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "print"
    ]
    assert printing == []
