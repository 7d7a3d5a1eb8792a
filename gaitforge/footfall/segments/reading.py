"""What the search over change times reads from the families: limb types, stance clauses, one spread."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from gaitforge.footfall.constraints import BalanceRule, ChangeRule, ConstraintSet, LimbRule, StanceClause
from gaitforge.footfall.problem import FootfallProblem

MOST_LIMBS = 200
"""Placement is recursive, one level a limb."""


class NotUnderstood(Exception):
    """The problem is one for the general model; the message says why."""


@dataclass(frozen=True)
class LimbType:
    """All rules on one row, merged; limbs of the same type may have the same rows."""

    most_changes: int | None = None
    swing_runs: frozenset[int] = frozenset()
    """Lengths no whole swing phase has."""
    stance_runs: frozenset[int] = frozenset()
    least_swing: int = 0
    least_stance: int = 0
    swing_in: frozenset[int] = frozenset()
    stance_in: frozenset[int] = frozenset()
    balanced: bool = False
    """Its time in swing is compared with that of others."""
    gapped: bool = False
    """It may not lift while another such limb lands."""


@dataclass(frozen=True)
class Reading:
    """A problem as the search over change times sees it."""

    columns: int
    """m"""
    cyclic: bool
    types: tuple[LimbType, ...]
    """One per row of C."""
    clauses: tuple[tuple[frozenset[int], int], ...]
    """(rows S, cap): in no column do more than cap limbs of S swing; cap < 0 is a clash by itself."""
    spread: int | None
    """Swing times of balanced limbs differ by at most this."""

    def asks_too_much(self, column: int) -> bool:
        """Must more limbs of some clause swing in this column than may?"""
        swinging = {i for i, t in enumerate(self.types) if column in t.swing_in}
        return any(len(swinging & limbs) > cap for limbs, cap in self.clauses)


def read(problem: FootfallProblem, families: Iterable[ConstraintSet]) -> Reading:
    """The families of a problem as data; raises NotUnderstood for what only the general model can take."""
    n = len(problem.limbs)
    if n > MOST_LIMBS:
        raise NotUnderstood(f"{n} limbs")
    found = _Collected([LimbType()] * n)
    for family in families:
        if family.scope == "general" or type(family).write is not ConstraintSet.write:
            raise NotUnderstood(f"{family.key} writes rows itself")
        for rule in family.rules(problem):
            found.add(rule, family.key)
    types = tuple(found.limb_type(i) for i in range(n))
    for limb_type in dict.fromkeys(types):
        _check(limb_type, problem)
    return Reading(problem.columns, problem.cyclic, types, tuple(found.tightest()), found.spread)


@dataclass
class _Collected:
    types: list[LimbType]
    clauses: dict[frozenset[int], int] = field(default_factory=dict)
    balanced: frozenset[int] = frozenset()
    gapped: frozenset[int] = frozenset()
    spread: int | None = None
    per_limb: dict[int, list[LimbRule]] = field(default_factory=dict)
    merged: dict[object, LimbType] = field(default_factory=dict)

    def add(self, rule: object, key: str) -> None:
        if isinstance(rule, LimbRule):
            self.per_limb.setdefault(rule.limb, []).append(rule)
        elif isinstance(rule, StanceClause):
            self._add_clause(rule, key)
        elif isinstance(rule, BalanceRule):
            self._add_balance(rule, key)
        elif isinstance(rule, ChangeRule):
            if self.gapped and self.gapped != set(rule.limbs):
                raise NotUnderstood(f"{key} speaks of several sets of limbs")
            self.gapped = frozenset(rule.limbs)
        else:
            raise NotUnderstood(f"{key} has a rule of another kind")

    def _add_clause(self, rule: StanceClause, key: str) -> None:
        limbs = frozenset(rule.limbs)
        if len(limbs) != len(rule.limbs):
            raise NotUnderstood(f"{key} counts a limb twice")
        if rule.at_least > 0:
            self.clauses[limbs] = min(self.clauses.get(limbs, len(limbs)), len(limbs) - rule.at_least)

    def _add_balance(self, rule: BalanceRule, key: str) -> None:
        limbs = frozenset(rule.limbs)
        if len(limbs) < 2:
            return
        if self.balanced and self.balanced != limbs:
            raise NotUnderstood(f"{key} balances another set of limbs")
        self.balanced = limbs
        self.spread = rule.spread if self.spread is None else min(self.spread, rule.spread)

    def tightest(self) -> Sequence[tuple[frozenset[int], int]]:
        """Clauses that no other implies: S with cap |S| − 1 follows from S' ⊂ S with cap |S'| − 1."""
        hard = [s for s, cap in self.clauses.items() if cap == len(s) - 1]
        return [(s, c) for s, c in self.clauses.items() if c < len(s) - 1 or not any(t < s for t in hard)]

    def limb_type(self, i: int) -> LimbType:
        """All rules on a row as one; most limbs share theirs, so each combination is merged once."""
        rules = self.per_limb.get(i, [])
        flags = i in self.balanced, i in self.gapped
        key = (*flags, *map(_demands, rules))
        if key not in self.merged:
            self.merged[key] = _merged(rules, *flags)
        return self.merged[key]


def _demands(rule: LimbRule) -> tuple[object, ...]:
    """What a rule says, whichever limb it is about."""
    return (
        rule.most_changes,
        rule.forbidden_swing_runs,
        rule.forbidden_stance_runs,
        rule.least_swing,
        rule.least_stance,
        rule.swing_in,
        rule.stance_in,
    )


def _merged(rules: Sequence[LimbRule], balanced: bool, gapped: bool) -> LimbType:
    return LimbType(
        most_changes=min((r.most_changes for r in rules if r.most_changes is not None), default=None),
        swing_runs=frozenset(length for r in rules for length in r.forbidden_swing_runs),
        stance_runs=frozenset(length for r in rules for length in r.forbidden_stance_runs),
        least_swing=max((r.least_swing for r in rules), default=0),
        least_stance=max((r.least_stance for r in rules), default=0),
        swing_in=frozenset(j for r in rules for j in r.swing_in),
        stance_in=frozenset(j for r in rules for j in r.stance_in),
        balanced=balanced,
        gapped=gapped,
    )


def _check(limb_type: LimbType, problem: FootfallProblem) -> None:
    """A row has one run of swing or of stance between its ends, and every rotation of a gait is a gait."""
    m = problem.columns
    fixed = (limb_type.swing_in, limb_type.stance_in)
    if problem.cyclic and any(0 < len(columns) < m for columns in fixed):
        raise NotUnderstood("a gait with a special column")
    constant = any(len(columns) == m for columns in fixed)
    limit = limb_type.most_changes
    if m > 3 and not constant and (limit is None or (limit >= 4 if problem.cyclic else limit > 2)):
        raise NotUnderstood("more than two changes a limb")
