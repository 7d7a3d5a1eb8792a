"""Constraint sets on the contact pattern C (n_F, m), g(C) ≤ 0, one family per file.

========  =========  ==============================================  ==============================
key       scope      sentence                                        over
========  =========  ==============================================  ==============================
g1        limb       Σ_j (C_ij − C_i,j+1)² ≤ 2                       limbs locomotive anywhere
g2        limb       no swing phase of 1 column                      limbs locomotive anywhere
g3, g4    limb       no stance phase of 1, of 2 columns              limbs locomotive anywhere
g5        limb       Σ_j C_ij ≤ m − 2                                limbs locomotive throughout
g6, g7    balance    |Σ_j C_aj − Σ_j C_bj| ≤ 2                       pairs locomotive throughout
g8        column     Σ_i C_ij ≥ 3                                    limbs locomotive anywhere
g9, g10   column     Σ_{i left} C_ij ≥ 1, Σ_{i right} C_ij ≥ 1       limbs locomotive anywhere
g11       column     disc of radius δ about p in support polygon     limbs locomotive anywhere
gap       change     nothing lifts while something else lands        limbs locomotive anywhere
========  =========  ==============================================  ==============================

In a cyclic gait columns wrap: C_i,m = C_i0.  `Roles` and `Boundary` belong to every problem.
Source: Whitman, Su, Coros, Ansari, Choset, IROS 2017, appendix; the gap rule is this project's.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from gaitforge.footfall.constraints.base import (
    BalanceConstraint,
    ChangeConstraint,
    ColumnConstraint,
    ConstraintSet,
    GeneralConstraint,
    LimbConstraint,
    Violation,
)
from gaitforge.footfall.constraints.g01_change_limit import ChangeLimit
from gaitforge.footfall.constraints.g02_swing_length import SwingLength
from gaitforge.footfall.constraints.g03_stance_length import StanceLength
from gaitforge.footfall.constraints.g04_stance_pair import StancePair
from gaitforge.footfall.constraints.g05_swing_duty import SwingDuty
from gaitforge.footfall.constraints.g06_shared_stance import SharedStance
from gaitforge.footfall.constraints.g07_shared_swing import SharedSwing
from gaitforge.footfall.constraints.g08_stance_count import StanceCount
from gaitforge.footfall.constraints.g09_left_stance import LeftStance
from gaitforge.footfall.constraints.g10_right_stance import RightStance
from gaitforge.footfall.constraints.g11_support_sectors import SupportSectors
from gaitforge.footfall.constraints.gap import GapRule
from gaitforge.footfall.constraints.roles import Boundary, Roles
from gaitforge.footfall.constraints.rules import BalanceRule, ChangeRule, LimbRule, StanceClause

__all__ = [
    "BalanceConstraint",
    "BalanceRule",
    "Boundary",
    "ChangeConstraint",
    "ChangeLimit",
    "ChangeRule",
    "ColumnConstraint",
    "ConstraintSet",
    "Families",
    "GapRule",
    "GeneralConstraint",
    "LeftStance",
    "LimbConstraint",
    "LimbRule",
    "RightStance",
    "Roles",
    "SharedStance",
    "SharedSwing",
    "StanceClause",
    "StanceCount",
    "StanceLength",
    "StancePair",
    "SupportSectors",
    "SwingDuty",
    "SwingLength",
    "Violation",
    "default_constraints",
    "with_problem_families",
]

Families = Iterable[ConstraintSet] | Mapping[str, ConstraintSet]


def default_constraints() -> tuple[ConstraintSet, ...]:
    """g1–g10 and the gap rule with their default parameters."""
    return (
        ChangeLimit(),
        SwingLength(),
        StanceLength(),
        StancePair(),
        SwingDuty(),
        SharedStance(),
        SharedSwing(),
        StanceCount(),
        LeftStance(),
        RightStance(),
        GapRule(),
    )


def with_problem_families(constraints: Families | None) -> tuple[ConstraintSet, ...]:
    """The given families (None: the default ones) with `Roles` and `Boundary`, which every problem has."""
    if constraints is None:
        chosen = default_constraints()
    else:
        chosen = tuple(constraints.values() if isinstance(constraints, Mapping) else constraints)
    present = {type(c) for c in chosen}
    extra = tuple(c for c in (Roles(), Boundary()) if type(c) not in present)
    return extra + chosen
