"""Problems small enough to look at every pattern there is."""

from itertools import product

import numpy as np

from gaitforge.footfall.constraints import (
    Boundary,
    ChangeLimit,
    GapRule,
    LeftStance,
    RightStance,
    Roles,
    SharedStance,
    SharedSwing,
    StanceCount,
    StanceLength,
    StancePair,
    SwingDuty,
    SwingLength,
    default_constraints,
    with_problem_families,
)
from gaitforge.footfall.problem import FootfallProblem

HEXAPOD = ("L1", "L2", "L3", "R1", "R2", "R3")
HEXAPOD_SIDES = ("left",) * 3 + ("right",) * 3
DODECAPOD = tuple(f"{side}{i}" for side in "LR" for i in range(1, 7))
DODECAPOD_SIDES = ("left",) * 6 + ("right",) * 6

LIMB_FAMILIES = (
    ChangeLimit(),
    ChangeLimit(at_most=1),
    ChangeLimit(at_most=4),
    SwingLength(),
    SwingLength(at_least=4),
    StanceLength(),
    StanceLength(at_least=4),
    StancePair(),
    StancePair(at_least=5),
    SwingDuty(),
    SwingDuty(at_least=3),
    Roles(),
    Boundary(),
)
OTHER_FAMILIES = (
    SharedStance(),
    SharedStance(at_most=1),
    SharedSwing(),
    SharedSwing(at_most=0),
    StanceCount(at_least=2),
    StanceCount(),
    StanceCount(all_but=1),
    LeftStance(),
    LeftStance(at_least=2),
    RightStance(),
    GapRule(),
    GapRule(up_to=2),
)
FAMILIES = LIMB_FAMILIES + OTHER_FAMILIES


def without_gap():
    """g1–g10, roles and boundary."""
    return with_problem_families([c for c in default_constraints() if c.key != "gap"])


def all_patterns(n, m):
    """Every contact matrix (n, m)."""
    for bits in product((False, True), repeat=n * m):
        yield np.array(bits).reshape(n, m)


def gait(walking, columns=12, limbs=HEXAPOD, sides=HEXAPOD_SIDES):
    """A cyclic problem."""
    walking = tuple(walking)
    return FootfallProblem(limbs, sides, columns, True, walking, walking)


def transition(first, last, columns, before=HEXAPOD, after=HEXAPOD, limbs=HEXAPOD, sides=HEXAPOD_SIDES):
    """A transition between two columns written as "0110…"."""
    ends = [np.array([c == "1" for c in column]) for column in (first, last)]
    return FootfallProblem(limbs, sides, columns, False, tuple(before), tuple(after), *ends)


def small(n, m, kind):
    """A tiny problem: "gait", "gait of some", "transition", or "changing roles"."""
    limbs = ("L1", "L2", "R1", "R2")[:1] if n == 1 else ("L1", "L2", "R1")[3 - n :]
    sides = tuple({"L": "left", "R": "right"}[name[0]] for name in limbs)
    if kind == "gait":
        return gait(limbs, m, limbs, sides)
    if kind == "gait of some":
        return gait(limbs[1:], m, limbs, sides)
    if kind == "transition":
        return transition("1" * n, "0" + "1" * (n - 1), m, limbs, limbs, limbs, sides)
    return transition("0" + "1" * (n - 1), "1" * n, m, limbs[1:], limbs, limbs, sides)


KINDS = ("gait", "gait of some", "transition", "changing roles")
