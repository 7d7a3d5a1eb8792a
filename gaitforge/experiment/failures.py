"""Limbs lost: which subsets of them, how, and what the rest of the robot makes of it."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any, ClassVar, cast

import numpy as np

from gaitforge.errors import InputError, Problem
from gaitforge.experiment.experiment import Experiment, Job, Row
from gaitforge.experiment.gaits import robot_called
from gaitforge.experiment.loss import LossJob
from gaitforge.report.results_page import Column
from gaitforge.task.roles import MODES, Mode

ALL = "all"
"""Instead of a number of subsets."""

COLUMNS = (
    Column("robot", "robot"), Column("limbs", "lost"), Column("mode", "mode"), Column("at", "at", 1.0, 2),
    Column("simulator", "simulator"), Column("status", "status"), Column("plans", "plans"),
    Column("proof", "proof"),
    Column("speed_m_s", "speed [cm/s]", 100.0), Column("speed_planned_m_s", "planned [cm/s]", 100.0),
    Column("margin_m", "margin [mm]", 1e3, 1), Column("tilt_worst_deg", "tilt [°]"),
    Column("unsupported_s", "no margin for [s]", 1.0, 2), Column("failed", "failed checks"),
    Column("source", "pattern"), Column("columns", "columns"), Column("plan_s", "planned in [s]", 1.0, 1),
)  # fmt: skip


@dataclass(frozen=True, kw_only=True, eq=False)
class Failures(Experiment):
    """Subsets of the limbs of each robot, by how many are lost; all of them or a seeded sample."""

    choosing: ClassVar[tuple[str, ...]] = ("robots", "modes")

    robots: Mapping[str, Sequence[int | str]]
    """Robot → how many subsets of one limb, of two, …: a number, or ``"all"``."""
    modes: tuple[Mode, ...] = ("locked",)
    cycles: tuple[int, int] = (1, 4)
    """Of the gaits before and after."""
    seed: int = 0
    """Of the subsets that are drawn, and of the moments at which limbs fail"""

    @property
    def columns(self) -> tuple[Column, ...]:
        return COLUMNS

    def jobs(self) -> Sequence[Job]:
        """Every subset in every mode; `InputError` for robots, numbers and modes that do not exist."""
        wrong = [m for m in self.modes if m not in MODES]
        if wrong or not self.modes:
            raise InputError(Problem("experiment", "modes", repr(list(self.modes)), "some of " + ", ".join(MODES)))
        return cast("list[Job]", [
            LossJob(robot, limbs, mode, self.cycles, self.seed)
            for robot, counts in self.robots.items()
            for limbs in self._subsets(robot, counts)
            for mode in self.modes
        ])  # fmt: skip

    def _subsets(self, robot: str, counts: Sequence[int | str]) -> Iterator[tuple[str, ...]]:
        names = robot_called(robot).limb_names
        if isinstance(counts, str) or not isinstance(counts, Sequence) or len(counts) > len(names):
            expected = f"a list: how many subsets of one limb, of two, … at most {len(names)}; a number or all"
            raise InputError(Problem("experiment", f"robots.{robot}", repr(counts), expected))
        for lost, most in enumerate(counts, 1):
            total = math.comb(len(names), lost)
            if most != ALL and (isinstance(most, bool) or not isinstance(most, int) or most < 0):
                expected = f"how many of the {total} subsets of {lost} limbs: 0, 1, …, or all"
                raise InputError(Problem("experiment", f"robots.{robot}.{lost - 1}", repr(most), expected))
            drawn = np.random.default_rng([self.seed, lost]).permutation(total)
            chosen = set(drawn[: total if most == ALL else int(most)].tolist())
            yield from (limbs for i, limbs in enumerate(combinations(names, lost)) if i in chosen)

    def told(self, row: Row) -> str:
        """Status, and why it is not verified."""
        why = row.get("proof") or row.get("error") or "; ".join(row.get("failed") or ())
        return f"{row['status']}{': ' if why else ''}{why or ''}"

    def picture(self, rows: Sequence[Row]) -> bytes | None:
        """How many subsets came to what, by robot and number of lost limbs."""
        from gaitforge.report.losses_plot import losses_png

        return losses_png(rows) if rows else None

    def made_of(self) -> Mapping[str, Any]:
        """Every robot's URDF."""
        return {name: hashlib.sha256(robot_called(name).urdf.encode()).hexdigest() for name in self.robots}
