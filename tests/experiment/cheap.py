"""An experiment whose jobs take no time: what the engine does with them is all there is to see."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from gaitforge.errors import UnsolvedError
from gaitforge.experiment.engine import ExperimentRun
from gaitforge.experiment.experiment import Experiment, Job, Row, Tools
from gaitforge.pipeline.options import Options
from gaitforge.report.results_page import Column


@dataclass(frozen=True)
class Cheap:
    """Says its value; some values stand for what can go wrong. Every measurement leaves a mark in `folder`."""

    key: str
    value: float
    folder: Path

    @property
    def case(self) -> Row:
        return {"value": self.value}

    def measure(self, tools: Tools) -> Sequence[Row]:
        with (self.folder / "marks.txt").open("a") as marks:
            marks.write(f"{self.key}\n")
        if self.key == "unsolved":
            raise UnsolvedError("no plan")
        if self.key == "broken":
            raise ZeroDivisionError("by zero")
        if self.key == "deadly":
            os._exit(9)
        return [{**self.case, "simulator": name, "status": "verified"} for name in tools.simulators]


@dataclass(frozen=True, kw_only=True, eq=False)
class CheapExperiment(Experiment):
    """Key → value."""

    values: Mapping[str, float]
    folder: Path
    version: str = ""

    @property
    def columns(self) -> tuple[Column, ...]:
        return (Column("key", "case"), Column("value", "value [cm]", 100.0, 1))

    def jobs(self) -> Sequence[Job]:
        return [Cheap(key, value, self.folder) for key, value in self.values.items()]

    def made_of(self) -> Mapping[str, str]:
        return {"robot": self.version}


def cheap_run(folder: Path, values: Mapping[str, float], **named: object) -> ExperimentRun:
    """A run of it in `folder`/run."""
    given = {"title": "Cheap", "simulators": {"none": None}, "workers": 1, **named}
    experiment = CheapExperiment(values=values, folder=folder, **given)  # type: ignore[arg-type]
    options = Options(simulator=None, recorder=None)  # type: ignore[arg-type]
    config = {"seed": 0, "experiment": {"values": dict(values), "workers": given["workers"]}}
    return ExperimentRun("cheap", experiment, options, folder / "run", config)


def marks(folder: Path) -> list[str]:
    """Keys in the order in which they were measured."""
    return (folder / "marks.txt").read_text().split()
