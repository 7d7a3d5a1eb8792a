"""Random problems with random families, for the searches to agree on."""

from dataclasses import dataclass
from typing import ClassVar

from hypothesis import strategies as st
from small_problems import HEXAPOD, gait, transition

from gaitforge.footfall.constraints import (
    ChangeLimit,
    ColumnConstraint,
    GapRule,
    LeftStance,
    RightStance,
    SharedStance,
    SharedSwing,
    StanceClause,
    StanceCount,
    StanceLength,
    StancePair,
    SwingDuty,
    SwingLength,
    with_problem_families,
)


@dataclass(frozen=True)
class Clauses(ColumnConstraint):
    """At least one limb of each set in stance in every column: the form of g11."""

    key: ClassVar[str] = "clauses"
    title: ClassVar[str] = "some of each set in stance"
    equation: ClassVar[str] = "Σ_{i ∈ S} C_ij ≥ 1"

    sets: tuple[tuple[int, ...], ...] = ()

    def rules(self, problem):
        return tuple(StanceClause(limbs, 1) for limbs in self.sets)

    def violations(self, contact, problem):
        empty = [(s, j) for s in self.sets for j in range(problem.columns) if not contact[list(s), j].any()]
        return [self.violation(problem, s, [j], "none of the set stands") for s, j in empty]


def _sometimes(draw, *families):
    return draw(st.sampled_from([*families, None]))


@st.composite
def families_for(draw, limbs):
    """g1–g10, gap rule and clauses, each with its own parameters or left out; g1 is always there."""
    subset = st.lists(st.integers(0, limbs - 1), min_size=min(2, limbs), unique=True).map(tuple)
    sets = draw(st.lists(subset, min_size=0, max_size=4))
    standing = draw(st.integers(0, max(1, limbs // 2)))
    chosen = [
        ChangeLimit(draw(st.sampled_from([2, 2, 2, 2, 2, 1, 0, 3]))),
        SwingLength(draw(st.sampled_from([2, 1, 3]))),
        _sometimes(draw, StanceLength()),
        _sometimes(draw, StancePair(), StancePair(at_least=4)),
        _sometimes(draw, SwingDuty(), SwingDuty(1), SwingDuty(3)),
        _sometimes(draw, SharedStance(), SharedStance(at_most=0)),
        _sometimes(draw, SharedSwing(), SharedSwing(at_most=1)),
        draw(st.sampled_from([StanceCount(standing), StanceCount(standing), StanceCount(all_but=2), None])),
        _sometimes(draw, LeftStance()) if limbs > 2 else None,
        _sometimes(draw, RightStance()) if limbs > 2 else None,
        GapRule(draw(st.sampled_from([0, 0, 6]))),
        Clauses(tuple(sets)) if sets else None,
    ]
    return with_problem_families([c for c in chosen if c is not None])


@st.composite
def problems(draw, most_limbs=6, most_columns=9):
    """A gait or a transition of some hexapod limbs, walking before, after, both or neither, with its families."""
    size = draw(st.integers(1, most_limbs).map(lambda n: most_limbs + 1 - n))  # large ones first
    limbs = tuple(sorted(draw(st.permutations(HEXAPOD))[:size]))
    sides = tuple({"L": "left", "R": "right"}[name[0]] for name in limbs)
    columns = draw(st.integers(2, most_columns).map(lambda m: most_columns + 2 - m))
    families = draw(families_for(size))
    walks = st.lists(st.sampled_from([True] * 8 + [False]), min_size=size, max_size=size)
    before = tuple(n for n, w in zip(limbs, draw(walks), strict=True) if w)
    if draw(st.booleans()):
        return gait(before, columns, limbs, sides), families
    after = before if draw(st.booleans()) else tuple(n for n, w in zip(limbs, draw(walks), strict=True) if w)
    stands = st.lists(st.sampled_from([True] * 5 + [False]), min_size=size, max_size=size)
    first, last = (
        "".join(str(int(n in walking and s)) for n, s in zip(limbs, draw(stands), strict=True))
        for walking in (before, after)
    )
    return transition(first, last, columns, before, after, limbs, sides), families
