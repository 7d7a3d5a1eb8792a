"""A segment's motion plan, or why it has none and what would help."""

from __future__ import annotations

from gaitforge.errors import UnsolvedError
from gaitforge.motion.explain import explained
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.refine import solve_refined
from gaitforge.motion.segment import Segment


def solve_segment(segment: Segment, options: MotionOptions) -> MotionPlan:
    """A plan whose spline keeps its bounds between samples too (`solve_refined`).

    Raises `UnsolvedError` when none was found: it says who is in the way and, where that is asked for
    (`options.explain`), what would help.
    """
    try:
        return solve_refined(segment, options)
    except UnsolvedError as failure:
        if not options.explain:
            raise
        raise explained(segment, options, failure) from None
