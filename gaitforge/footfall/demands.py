"""What families ask of the cells of C, in a form that a picture can be drawn from."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any, Literal

from gaitforge.footfall.constraints import ConstraintSet, LimbRule, StanceClause
from gaitforge.footfall.constraints.rules import BalanceRule, Rule
from gaitforge.footfall.problem import FootfallProblem

Wants = Literal["stance", "swing", "order"]
"""order: something about when limbs change, which no single cell shows"""


@dataclass(frozen=True)
class Demand:
    """One sentence of a family about some limbs and columns."""

    family: str
    title: str
    wants: Wants
    limbs: tuple[str, ...]
    columns: tuple[int, ...]
    at_least: int
    """stance: limbs in each of the columns; swing: columns of each of the limbs; order: 0"""
    text: str

    def as_dict(self) -> dict[str, Any]:
        """Plain lists, strings and numbers."""
        return {**asdict(self), "limbs": list(self.limbs), "columns": list(self.columns)}


def demands_of(
    problem: FootfallProblem, families: Sequence[ConstraintSet], names: Sequence[str], limbs: Sequence[str]
) -> tuple[Demand, ...]:
    """The sentences of the named families that concern some of `limbs`; those alike of several limbs are one."""
    together: dict[tuple[object, ...], Demand] = {}
    for family in families:
        for demand in _demands(problem, family, set(limbs)) if family.name in names else ():
            key = (demand.family, demand.wants, demand.columns, demand.at_least, demand.text)
            known = together.get(key)
            merged = demand if known is None else replace(known, limbs=tuple({**_keys(known), **_keys(demand)}))
            together[key] = merged
    return tuple(together.values())


def _keys(demand: Demand) -> dict[str, None]:
    return dict.fromkeys(demand.limbs)


def _demands(problem: FootfallProblem, family: ConstraintSet, limbs: set[str]) -> Iterator[Demand]:
    everywhere = tuple(range(problem.columns))
    rules = family.rules(problem)
    if not rules:
        yield Demand(family.name, family.title, "order", tuple(sorted(limbs)), everywhere, 0, family.equation)
    for rule in rules:
        names = tuple(problem.limbs[i] for i in ((rule.limb,) if isinstance(rule, LimbRule) else rule.limbs))
        if not limbs & set(names):
            continue
        for wants, columns, least, text in _sentences(rule, everywhere):
            yield Demand(family.name, family.title, wants, names, columns, least, text)


def _sentences(rule: Rule, everywhere: tuple[int, ...]) -> Iterator[tuple[Wants, tuple[int, ...], int, str]]:
    if isinstance(rule, StanceClause):
        yield "stance", everywhere, rule.at_least, f"{rule.at_least} of these in stance in every column"
    elif isinstance(rule, BalanceRule):
        yield "order", everywhere, 0, f"stance times at most {rule.spread} columns apart"
    elif isinstance(rule, LimbRule):
        yield from _of_limb(rule, everywhere)
    else:
        yield "order", everywhere, 0, "no lifting while another lands"


def _of_limb(rule: LimbRule, everywhere: tuple[int, ...]) -> Iterator[tuple[Wants, tuple[int, ...], int, str]]:
    if rule.most_changes is not None:
        yield "order", everywhere, 0, f"at most {rule.most_changes} changes"
    for kind, lengths in (("swing", rule.forbidden_swing_runs), ("stance", rule.forbidden_stance_runs)):
        if lengths:
            yield "order", everywhere, 0, f"no {kind} phase of {' or '.join(map(str, lengths))} columns"
    if rule.least_swing:
        yield "swing", everywhere, rule.least_swing, f"at least {rule.least_swing} columns in swing"
    if rule.least_stance:
        yield "order", everywhere, 0, f"at least {rule.least_stance} columns in stance"
    if rule.swing_in:
        yield "swing", rule.swing_in, len(rule.swing_in), f"swing in {_listed(rule.swing_in, everywhere)}"
    if rule.stance_in:
        yield "stance", rule.stance_in, 1, f"stance in {_listed(rule.stance_in, everywhere)}"


def _listed(columns: tuple[int, ...], everywhere: tuple[int, ...]) -> str:
    if columns == everywhere:
        return "every column"
    return ("column " if len(columns) == 1 else "columns ") + ", ".join(str(j + 1) for j in columns)
