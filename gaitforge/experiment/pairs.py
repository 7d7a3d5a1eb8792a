"""Every ordered pair of gaits: the transition between them by several methods, in several simulators."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import permutations
from typing import Any, Literal, cast

from gaitforge.errors import InputError, Problem
from gaitforge.experiment.change import ChangeJob
from gaitforge.experiment.experiment import Experiment, Job, Row, Tools
from gaitforge.experiment.gaits import GaitCase, PlannedGait, plan_gait_case, read_gaits, robot_called
from gaitforge.experiment.processes import Processes
from gaitforge.pipeline.stopwatch import Progress
from gaitforge.report.results_page import Column

Method = Literal["optimise", "interpolate"]
COLUMNS = (
    Column("robot", "robot"), Column("before", "from"), Column("after", "to"), Column("method", "method"),
    Column("simulator", "simulator"), Column("published_m_s", "paper [cm/s]", 100.0),
    Column("speed_m_s", "speed [cm/s]", 100.0), Column("speed_share", "of commanded [%]", 100.0, 1),
    Column("heading_deg", "heading [°]"), Column("tilt_deg", "tilt [°]"), Column("margin_m", "margin [mm]", 1e3, 1),
    Column("slip_m", "slip [mm]", 1e3, 1), Column("gait_margin_m", "gaits' margin [mm]", 1e3, 1),
    Column("fallen", "fallen"), Column("verified", "verified"),
    Column("columns", "columns"), Column("duration_s", "time [s]"), Column("plan_s", "planned in [s]", 1.0, 1),
)  # fmt: skip


@dataclass(frozen=True, kw_only=True, eq=False)
class Pairs(Experiment):
    """Gaits as data; each is planned once, then every ordered pair of gaits of one robot by every method."""

    robots: Mapping[str, Mapping[str, Any]]
    """Robot → gait's name → the gait, as a phase of a task."""
    methods: tuple[Method, ...] = ("interpolate", "optimise")
    cycles: tuple[int, int] = (2, 2)
    """Of the gaits before and after."""
    phases: Literal["seam", "paper", "best"] = "best"
    """Where in their cycles an optimised transition joins the gaits (``pipeline.transition_phases``)."""
    published: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    """``before_to_after`` → method → speed of the literature [m/s]"""

    @property
    def columns(self) -> tuple[Column, ...]:
        return COLUMNS

    @cached_property
    def gaits(self) -> dict[str, dict[str, GaitCase]]:
        """Robot → gait's name → gait."""
        found = {name: read_gaits(name, gaits, "experiment") for name, gaits in self.robots.items()}
        few = [name for name, gaits in found.items() if len(gaits) < 2]
        if few or not found:
            where = ", ".join(f"robots.{name}" for name in few) or "robots"
            raise InputError(Problem("experiment", where, "fewer than two gaits", "at least two"))
        return found

    def jobs(self) -> Sequence[Job]:
        return [
            self._job(before, after, method)
            for gaits in self.gaits.values()
            for before, after in permutations(gaits.values(), 2)
            for method in self.methods
        ]

    def _job(self, before: GaitCase, after: GaitCase, method: Method) -> ChangeJob:
        known = self.published.get(f"{before.phase.name}_to_{after.phase.name}", {})
        return ChangeJob(before, after, method, self.cycles, self.phases, known.get(method))

    def made_of(self) -> Mapping[str, str]:
        return {name: hashlib.sha256(robot_called(name).urdf.encode()).hexdigest() for name in self.robots}

    def prepare(self, jobs: Sequence[Job], work: Processes, tools: Tools, progress: Progress) -> Iterator[Job]:
        changes = cast("Sequence[ChangeJob]", jobs)
        cases = list({(c.robot, c.phase.name): c for job in changes for c in (job.before, job.after)}.values())
        plans: dict[tuple[str, str], PlannedGait | Exception] = {}
        for index, result in work.run((plan_gait_case, (case, tools.options)) for case in cases):
            name = cases[index].robot, cases[index].phase.name
            plans[name] = result
            progress("motion", f"gait {name[0]}.{name[1]}: {_told(result)}")
        for job in changes:
            both = [plans[c.robot, c.phase.name] for c in (job.before, job.after)]
            yield replace(job, plans=(both[0], both[1]))

    def told(self, row: Row) -> str:
        if not row["measured"]:
            return f"{row['status']}: {row['error']}"
        words = f"{row['simulator']} {100 * row['speed_m_s']:.2f} cm/s, tilt {row['tilt_deg']:.1f}°"
        return f"{words}, fallen" if row["fallen"] else f"{words}, {row['status']}"

    def picture(self, rows: Sequence[Row]) -> bytes | None:
        from gaitforge.report.change_plot import change_png

        measured = [row for row in rows if row["measured"]]
        return change_png(measured) if measured else None


def _told(result: PlannedGait | Exception) -> str:
    if isinstance(result, Exception):
        return f"none ({result})"
    pattern = result.plan.pattern
    return f"{pattern.source}, {len(pattern.locomotive)} limbs walk, {result.seconds:.1f} s"
