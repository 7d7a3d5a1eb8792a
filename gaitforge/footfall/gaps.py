"""Patterns whose steps are a little shorter, so that feet land before others lift."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gaitforge.footfall.constraints import ConstraintSet
from gaitforge.footfall.model import check_pattern
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.footfall.problem import FootfallProblem
from gaitforge.footfall.seam import at_grounded_seam

FEW = 3
"""With so few feet on the ground, one that a swap shakes off leaves an edge to stand on, not a face."""


def needs_gaps(pattern: FootfallPattern) -> bool:
    """Do three feet or fewer ever hold the robot?"""
    return int(pattern.contact.sum(axis=0).min()) <= FEW


def with_gaps(pattern: FootfallPattern) -> FootfallPattern:
    """The cyclic pattern with every swing ended a column earlier where another limb lifts as it lands.

    A swap at one instant is two impacts in one; after the trimming no boundary has both, except where
    a swing would be left without two columns.
    """
    contact = pattern.contact.copy()
    following = np.roll(pattern.contact, -1, axis=1)
    lands, lifts = ~pattern.contact & following, pattern.contact & ~following
    for j in np.flatnonzero(lands.any(axis=0) & lifts.any(axis=0)):
        for i in np.flatnonzero(lands[:, j]):
            if not contact[i, j - 1]:
                contact[i, j] = True
    return replace(pattern, contact=contact, info={**pattern.info, "gaps": True})


def gapped_first(
    patterns: Sequence[FootfallPattern], problem: FootfallProblem, families: Sequence[ConstraintSet]
) -> list[FootfallPattern]:
    """The gaits in their order, with gaps where few feet hold the robot and the families allow them.

    Those that lost their place to their gapped version follow at the end.
    """
    first, last = [], []
    for pattern in patterns:
        there = replace(problem, columns=pattern.columns)
        gapped = at_grounded_seam(with_gaps(pattern)) if needs_gaps(pattern) else pattern
        if gapped is not pattern and check_pattern(gapped.contact, there, families):
            gapped = pattern
        first.append(gapped)
        last += [pattern] if gapped is not pattern else []
    return first + last
