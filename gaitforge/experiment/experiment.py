"""What an experiment is: jobs, what has to hold of their rows, and how these are shown."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

from gaitforge.experiment.acceptance import Rule
from gaitforge.report.results_page import Column

if TYPE_CHECKING:
    from gaitforge.experiment.processes import Processes
    from gaitforge.pipeline.options import Options
    from gaitforge.pipeline.stopwatch import Progress
    from gaitforge.verify.simulator import Simulator

Row = Mapping[str, Any]


@dataclass(frozen=True, eq=False)
class Tools:
    """What jobs work with; goes to other processes."""

    options: Options
    simulators: Mapping[str, Simulator]
    logs: Path | None = None
    """Folder for the log of every run; None: no logs"""


class Job(Protocol):
    """One unit of work that leaves one row or several, a row a simulator say; goes to other processes."""

    @property
    def key(self) -> str:
        """Its name, also that of its file: letters, digits, ``_``, ``-`` and ``.``."""
        ...

    @property
    def case(self) -> Row:
        """What identifies its rows, for when there is nothing else to say about them."""
        ...

    def measure(self, tools: Tools) -> Sequence[Row]:
        """The rows; a `GaitforgeError` or any other exception becomes a row that was not measured."""
        ...


@dataclass(frozen=True, kw_only=True, eq=False)
class Experiment(ABC):
    """Cases as data; a new kind of experiment is a subclass that a ``conf/experiment/*.yaml`` names as its target."""

    choosing: ClassVar[tuple[str, ...]] = ()
    """Parameters that say which rows there are, not what is in them: rows of an earlier run with others are kept."""

    title: str
    simulators: Mapping[str, Any]
    """Name → simulator (config group ``verify``)."""
    accept: tuple[Mapping[str, Any], ...] = ()
    """What rows have to keep, see `Rule`."""
    only: tuple[str, ...] = ()
    """Patterns (``*`` and ``?``) of the keys of the jobs that are run; none: all."""
    workers: int = 2
    """Processes that measure at the same time."""
    logs: bool = False
    """Write a log for every run?"""
    resume: str | None = None
    """Folder of an earlier run whose rows are kept."""
    rules: tuple[Rule, ...] = field(init=False)

    def __post_init__(self) -> None:
        if self.workers < 1:
            raise ValueError(f"workers: found {self.workers}, expected at least one process")
        if not self.simulators:
            raise ValueError("simulators: found none, expected at least one")
        object.__setattr__(self, "rules", tuple(Rule.read(rule, f"accept.{i}") for i, rule in enumerate(self.accept)))

    @property
    @abstractmethod
    def columns(self) -> tuple[Column, ...]:
        """Of the page's table."""

    @abstractmethod
    def jobs(self) -> Sequence[Job]:
        """All jobs, in the order of the table; `InputError` for data that make no sense."""

    def prepare(self, jobs: Sequence[Job], work: Processes, tools: Tools, progress: Progress) -> Iterator[Job]:
        """The jobs with what several of them share made once (gaits, say), each as soon as it can be measured."""
        del work, tools, progress
        yield from jobs

    def told(self, row: Row) -> str:
        """A row in a few words, for the terminal."""
        return str(row["status"])

    def picture(self, rows: Sequence[Row]) -> bytes | None:
        """PNG of all rows; None when there is nothing to draw."""
        del rows
        return None

    def made_of(self) -> Mapping[str, str]:
        """What rows depend on besides the config: robot → hash of its URDF, say."""
        return {}

    def selected(self) -> list[Job]:
        """The jobs that `only` leaves."""
        return [j for j in self.jobs() if not self.only or any(fnmatchcase(j.key, p) for p in self.only)]
