"""Patterns whose steps are a little shorter, so that feet land before others lift."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gaitforge.footfall.pattern import FootfallPattern

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
