"""The integer program of the appendix as plain data: 0/1 variables C, x, y, counts z, linear rows.

Every quadratic term of the paper is an exclusive-or, (C_ij − C_i,j+1)² = C_ij ⊕ C_i,j+1, so the program
is linear and any integer solver can take it as it stands.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gaitforge.footfall.problem import FootfallProblem


class Row(NamedTuple):
    """lower ≤ Σ coefficient · variable ≤ upper; None leaves a side open."""

    terms: tuple[tuple[int, int], ...]
    """(variable, coefficient), each variable once"""
    lower: int | None
    upper: int | None
    family: str
    limbs: tuple[int, ...] = ()
    """Rows of C that the row speaks of; empty when it speaks of all."""
    columns: tuple[int, ...] = ()

    def holds(self, values: NDArray[np.int_]) -> bool:
        """Whether the row holds for `values`, one integer per variable of the program."""
        total = sum(coefficient * int(values[variable]) for variable, coefficient in self.terms)
        return (self.lower is None or total >= self.lower) and (self.upper is None or total <= self.upper)


@dataclass(eq=False)
class Program:
    """Variables and rows while they are being written; one per problem.

    Variables are numbered: C_ij first (row by row), then what h1 and h2 need, then whatever a family adds.
    """

    problem: FootfallProblem
    bounds: list[tuple[int, int]] = field(default_factory=list)
    """Smallest and largest value per variable."""
    rows: list[Row] = field(default_factory=list)
    exact: bool = True
    """Whether every C has one value of all other variables, which listing needs; without it x and y are only
    bounded from below, which is enough to minimise Σ y and makes a much smaller program."""
    boundaries: tuple[tuple[int, int], ...] = field(init=False)
    """Neighbouring columns (j, j + 1): m − 1 of them, and in a cyclic program the wrap (m − 1, 0) as well."""

    def __post_init__(self) -> None:
        n, m = len(self.problem.limbs), self.problem.columns
        inner = tuple((j, j + 1) for j in range(m - 1))
        self.boundaries = (*inner, (m - 1, 0)) if self.problem.cyclic else inner
        self.bounds = [(0, 1)] * (n * m)
        self._count_changes()

    def contact(self, limb: int, column: int) -> int:
        """Variable C_ij; in a cyclic program columns wrap."""
        return limb * self.problem.columns + column % self.problem.columns

    def change(self, limb: int, boundary: int) -> int:
        """Variable x_ij = (C_ij − C_i,j+1)²."""
        return self._x + limb * len(self.boundaries) + boundary

    def changed(self, boundary: int) -> int:
        """Variable y_j: does any limb change at this boundary."""
        return self._y + boundary

    @property
    def objective(self) -> tuple[int, ...]:
        """The variables y_j whose sum is minimised, equation (2)."""
        return tuple(self.changed(j) for j in range(len(self.boundaries)))

    def integer(self, lower: int, upper: int) -> int:
        """A new variable with lower ≤ value ≤ upper."""
        self.bounds.append((lower, upper))
        return len(self.bounds) - 1

    def boolean(self) -> int:
        """A new 0/1 variable."""
        return self.integer(0, 1)

    def row(
        self,
        terms: Iterable[tuple[int, int]],
        lower: int | None,
        upper: int | None,
        family: str,
        limbs: tuple[int, ...] = (),
        columns: tuple[int, ...] = (),
    ) -> None:
        """Add lower ≤ Σ coefficient · variable ≤ upper; a variable may occur in several terms."""
        collected: dict[int, int] = {}
        for variable, coefficient in terms:
            collected[variable] = collected.get(variable, 0) + coefficient
        kept = tuple((v, c) for v, c in collected.items() if c)
        self.rows.append(Row(kept, lower, upper, family, limbs, columns))

    def clause(
        self,
        true: Iterable[int],
        false: Iterable[int],
        family: str,
        limbs: tuple[int, ...] = (),
        columns: tuple[int, ...] = (),
    ) -> None:
        """At least one of the 0/1 variables `true` is 1, or one of `false` is 0."""
        positive, negative = set(true), set(false)
        if not positive.isdisjoint(negative):
            return  # always so: a window that wraps onto itself
        terms = (*[(v, 1) for v in sorted(positive)], *[(v, -1) for v in sorted(negative)])
        self.rows.append(Row(terms, 1 - len(negative), None, family, limbs, columns))

    def _count_changes(self) -> None:
        """h1: z_j = Σ_i x_ij with x_ij = C_ij ⊕ C_i,j+1; h2: (y_j − 1) z_j = 0, and y_j = 0 where z_j = 0."""
        n, count = len(self.problem.limbs), len(self.boundaries)
        self._x = len(self.bounds)
        self.bounds += [(0, 1)] * (n * count)
        self._y = len(self.bounds)
        self.bounds += [(0, 1)] * count
        if not self.exact:
            self._bound_changes()
            return
        self._z = len(self.bounds)
        self.bounds += [(0, n)] * count
        for j, (here, there) in enumerate(self.boundaries):
            for i in range(n):
                a, b, x = self.contact(i, here), self.contact(i, there), self.change(i, j)
                self.clause([x, b], [a], "h1")
                self.clause([x, a], [b], "h1")
                self.clause([a, b], [x], "h1")
                self.clause([], [a, b, x], "h1")
            z, y = self._z + j, self.changed(j)
            self.row([(z, 1)] + [(self.change(i, j), -1) for i in range(n)], 0, 0, "h1")
            self.row([(z, 1), (y, -n)], None, 0, "h2")
            self.row([(z, 1), (y, -1)], 0, None, "h2")

    def _bound_changes(self) -> None:
        """x_ij ≥ |C_ij − C_i,j+1| and y_j ≥ x_ij: the program's optimum is the same."""
        for j, (here, there) in enumerate(self.boundaries):
            for i in range(len(self.problem.limbs)):
                a, b, x = self.contact(i, here), self.contact(i, there), self.change(i, j)
                self.clause([x, b], [a], "h1")
                self.clause([x, a], [b], "h1")
                self.clause([self.changed(j)], [x], "h2")

    def matrix(self, values: NDArray[np.int_]) -> NDArray[np.bool_]:
        """(n_F, m) C out of one value per variable."""
        n, m = len(self.problem.limbs), self.problem.columns
        return np.asarray(values[: n * m], dtype=bool).reshape(n, m)
