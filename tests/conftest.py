"""What every test may use: one thread a solver, and the command line run in a folder of its own."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import absl.logging
import pytest

# OR-Tools' MathOpt brings absl, whose log handler keeps the stream it found and closes it when Hydra sets up
# logging, unless it is one of the interpreter's own; under pytest it would close the capture of the whole session.
absl.logging.get_absl_handler().python_handler.stream = sys.__stderr__

for _variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_variable, "1")

REPOSITORY = Path(__file__).resolve().parents[1]


@dataclass(frozen=True)
class Finished:
    """A finished command line."""

    code: int
    out: str
    err: str
    folder: Path

    @property
    def files(self) -> list[str]:
        """Everything that it left, folders included."""
        return sorted(str(p.relative_to(self.folder)) for p in self.folder.rglob("*"))


@pytest.fixture
def gaitforge(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> Callable[..., Finished]:
    """Run the command line in an empty working folder: ``gaitforge("robot=hexapod", …)``."""
    folder = tmp_path / "work"
    folder.mkdir()
    monkeypatch.chdir(folder)

    def run(*arguments: str) -> Finished:
        from gaitforge.cli import main

        capfd.readouterr()
        code = main(list(arguments))
        out, err = capfd.readouterr()
        return Finished(code, out, err, folder)

    return run
