"""What a family asks for, as data: one small frozen value per scope, and how each becomes rows.

A fast search reads the data; the general program takes the rows.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from gaitforge.footfall.program import Program


@dataclass(frozen=True)
class LimbRule:
    """A rule on the row of one limb; columns wrap in a cyclic gait, runs cut off by an end are exempt elsewhere."""

    limb: int
    """Row of C"""
    most_changes: int | None = None
    """Σ_j (C_ij − C_i,j+1)² at most this"""
    forbidden_swing_runs: tuple[int, ...] = ()
    """No swing phase lasts exactly so many columns."""
    forbidden_stance_runs: tuple[int, ...] = ()
    """No stance phase lasts exactly so many columns."""
    least_swing: int = 0
    """At least so many columns in swing."""
    least_stance: int = 0
    """At least so many columns in stance."""
    swing_in: tuple[int, ...] = ()
    """Columns that are swing."""
    stance_in: tuple[int, ...] = ()
    """Columns that are stance."""

    def write(self, program: Program, family: str) -> None:
        """Add the rows of this rule."""
        m, who = program.problem.columns, (self.limb,)
        cells = [program.contact(self.limb, j) for j in range(m)]
        if self.most_changes is not None:
            changes = [(program.change(self.limb, j), 1) for j in range(len(program.boundaries))]
            program.row(changes, None, self.most_changes, family, who)
        if self.least_swing:
            program.row([(c, 1) for c in cells], None, m - self.least_swing, family, who)
        if self.least_stance:
            program.row([(c, 1) for c in cells], self.least_stance, None, family, who)
        for length in self.forbidden_swing_runs:
            self._forbid(program, cells, family, length, stance=False)
        for length in self.forbidden_stance_runs:
            self._forbid(program, cells, family, length, stance=True)
        for j in self.swing_in:
            program.clause([], [cells[j]], family, who, (j,))
        for j in self.stance_in:
            program.clause([cells[j]], [], family, who, (j,))

    def _forbid(self, program: Program, cells: Sequence[int], family: str, length: int, stance: bool) -> None:
        """No window ``a b…b a`` with `length` b: the form of g2, g3 and g4."""
        m = program.problem.columns
        starts = range(m) if program.problem.cyclic else range(m - length - 1)
        for j in starts:
            columns = tuple([(j + k) % m for k in range(length + 2)])
            first, *inside, last = [cells[k] for k in columns]
            true, false = ((first, last), inside) if stance else (inside, (first, last))
            program.clause(true, false, family, (self.limb,), columns)


@dataclass(frozen=True)
class BalanceRule:
    """The time in stance of any two of these limbs differs by at most `spread` columns."""

    limbs: tuple[int, ...]
    spread: int

    def write(self, program: Program, family: str) -> None:
        """Add the rows of this rule: one total per limb, one row per ordered pair."""
        m = program.problem.columns
        if not program.exact:
            self._write_window(program, family)
            return
        totals = {}
        for i in self.limbs:
            totals[i] = program.integer(0, m)
            cells = [(program.contact(i, j), -1) for j in range(m)]
            program.row([(totals[i], 1), *cells], 0, 0, family, (i,))
        for a in self.limbs:
            for b in self.limbs:
                if a != b:
                    program.row([(totals[a], 1), (totals[b], -1)], None, self.spread, family, (a, b))

    def _write_window(self, program: Program, family: str) -> None:
        """All totals lie in one window of `spread` columns: fewer rows, but its place is not unique."""
        m = program.problem.columns
        least = program.integer(0, m)
        for i in self.limbs:
            cells = [(program.contact(i, j), 1) for j in range(m)]
            program.row([*cells, (least, -1)], 0, self.spread, family, (i,))


@dataclass(frozen=True)
class StanceClause:
    """At least `at_least` of these limbs are in stance, in every column."""

    limbs: tuple[int, ...]
    at_least: int

    def write(self, program: Program, family: str) -> None:
        """Add the rows of this rule, one per column."""
        for j in range(program.problem.columns):
            cells = [(program.contact(i, j), 1) for i in self.limbs]
            program.row(cells, self.at_least, None, family, self.limbs, (j,))


@dataclass(frozen=True)
class ChangeRule:
    """At one column boundary these limbs only lift or only land."""

    limbs: tuple[int, ...]

    def write(self, program: Program, family: str) -> None:
        """Add the rows of this rule: per boundary a 0/1 variable, 1 where limbs lift and 0 elsewhere."""
        for j, (here, there) in enumerate(program.boundaries):
            lifting, columns = program.boolean(), (here, there)
            for i in self.limbs:
                a, b = program.contact(i, here), program.contact(i, there)
                program.clause([b, lifting], [a], family, (i,), columns)
                program.clause([a], [b, lifting], family, (i,), columns)
            # settles the variable where nothing changes, so that a pattern is counted once
            program.clause([program.changed(j)], [lifting], family, (), columns)


Rule = LimbRule | BalanceRule | StanceClause | ChangeRule
