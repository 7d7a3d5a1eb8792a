"""What touched what: slip, unplanned contact, margin, agreement with C."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from gaitforge.robot.gravity import GRAVITY
from gaitforge.verify.checks.base import Finding, Rows, Segment, SegmentCheck
from gaitforge.verify.feet import CONTACT_N
from gaitforge.verify.grasps import leaning_rows
from gaitforge.verify.limp import limp_feet
from gaitforge.verify.support import bridged, static_margin

Array = NDArray[np.float64]
TOUCHES_M = 0.0005
"""[m] above the ground up to which a foot touches it"""


def slip_per_stance(slip_speed: Array, planned: NDArray[np.bool_], dt: float) -> float:
    """Longest path [m] of one foot's contact point in one stance.

    slip_speed (n,) [m/s], 0 in the air; planned (n,) contact.  A stance reaches from the middle of
    the planned swing before to the middle of the one after it, so that a touch-down that comes
    early and a foot that bounces belong to it.
    """
    path = np.concatenate([[0.0], np.cumsum(slip_speed) * dt])
    edges = np.flatnonzero(np.diff(planned.astype(int)))
    lifts, lands = edges[~planned[edges + 1]], edges[planned[edges + 1]]
    middles = [(lift + land) // 2 + 1 for lift in lifts for land in lands[lands > lift][:1]]
    return float(np.diff(path[[0, *middles, len(slip_speed)]]).max())


@dataclass(frozen=True)
class Slip(SegmentCheck):
    """∫ of the tangential speed of the contact point, rolling taken out, per stance; the worst foot."""

    name: ClassVar[str] = "slip"
    title: ClassVar[str] = "slip in one stance"

    def find(self, segment: Segment) -> Finding:
        rows, trace = segment.judged, segment.trace
        worst = max(
            slip_per_stance(trace.slip_speed[rows, foot], trace.plan.contact[rows, foot], segment.dt)
            for foot, limb in enumerate(segment.robot.limb_names)
            if limb not in segment.entry.plan.limp
        )
        return Finding.at_most(1000.0 * worst, segment.limit.slip_mm, "mm")


@dataclass(frozen=True)
class UnplannedContacts(SegmentCheck):
    """Number of contacts, at any time of the segment, of anything but a planned foot with the ground."""

    name: ClassVar[str] = "unplanned_contact"
    title: ClassVar[str] = "unplanned contacts"

    def find(self, segment: Segment) -> Finding:
        start, end = segment.entry.start, segment.entry.end
        events = [e for e in segment.trace.unplanned if e.time < end and e.end >= start and e.kind != "limp"]
        return Finding.at_most(len(events), 0, "events")


@dataclass(frozen=True)
class LimpContacts(SegmentCheck):
    """Number of contacts of limp limbs, with whatever; none where no limb is limp."""

    name: ClassVar[str] = "limp_contact"
    title: ClassVar[str] = "contacts of limp limbs"

    def find(self, segment: Segment) -> Finding | None:
        if not segment.entry.plan.limp:
            return None
        start, end = segment.entry.start, segment.entry.end
        events = [e for e in segment.trace.unplanned if e.time < end and e.end >= start and e.kind == "limp"]
        return Finding(len(events), None, "events")


@dataclass(frozen=True)
class StaticMargin(SegmentCheck):
    """Smallest distance of the centre of mass inside the polygon of the feet that hold the robot.

    Rigid feet on rigid ground hop by tenths of a millimetre when the load moves from one to another.
    A lost contact counts once it has lasted √(z / g), z the height of the centre of mass: the time
    constant with which a body tips, about 0.12 s for a hexapod and 0.2 s for a tall quadruped.  And
    where one set of feet takes over from another, some land a step or two after others have lifted:
    a margin counts once it has lasted `margin_hold_s`.

    Tips on a load that stands on something support nothing, and the load counts from when it is lifted
    (`grasps.laden_com`): a robot that leans on what it holds has a margin below zero.  As if the load gave way,
    a foot in its planned stance counts then, too, that touches the ground and whose weight the tips have taken.

    Where a plan says that nothing balances the robot at first (`MotionPlan.unbalanced_s`: a leg that bore it is gone),
    it is judged from then on; `Unsupported` says for how long it was without a margin.
    """

    name: ClassVar[str] = "static_margin"
    title: ClassVar[str] = "static margin from real contacts"

    def find(self, segment: Segment) -> Finding:
        rows, since = segment.judged, segment.entry.start + segment.entry.plan.unbalanced_s
        margin = bridged_margin(segment, rows[segment.trace.times[rows] >= since - 1e-9])
        value = lasting_minimum(margin, max(round(segment.limits.margin_hold_s / segment.dt), 1))
        return Finding.at_least(1000.0 * value, self._limit(segment), "mm")

    @staticmethod
    def _limit(segment: Segment) -> float | None:
        limit = segment.limit
        laden = any(h.mass > 0.0 for h in segment.entry.plan.holdings)
        return limit.laden_margin_mm if laden and limit.laden_margin_mm is not None else limit.static_margin_mm


@dataclass(frozen=True)
class Unsupported(SegmentCheck):
    """How long there was no static margin in a segment that begins without balance; *fallen* and *tilt* judge it."""

    name: ClassVar[str] = "unsupported"
    title: ClassVar[str] = "time without a static margin"

    def find(self, segment: Segment) -> Finding | None:
        if segment.entry.plan.unbalanced_s == 0.0:
            return None
        seconds = float((bridged_margin(segment, segment.judged) < 0.0).sum()) * segment.dt
        return Finding(seconds, None, "s")


def bridged_margin(segment: Segment, rows: Rows) -> Array:
    """(k,) static margin [m] at these rows of the trace, contacts that are lost for a moment counted as held."""
    trace = segment.trace
    height = float(np.median(trace.com[rows, 2]))
    steps = int(np.sqrt(max(height, 0.0) / GRAVITY) / segment.dt)
    bears = (trace.normal_force > CONTACT_N) & ~limp_feet(segment.timeline, trace.plan.segment)
    holds = bridged(bears, steps) | _would_bear(segment)
    return static_margin(trace.com[rows, :2], trace.contact_points[rows, :, :2], holds[rows])


def _would_bear(segment: Segment) -> NDArray[np.bool_]:
    """(n, n_F) feet in their planned stance that touch the ground while tips may have taken their weight."""
    trace, radii = segment.trace, np.array([limb.foot.radius for limb in segment.robot.limbs])
    touches = trace.plan.contact & (trace.feet[:, :, 2] - radii < TOUCHES_M)
    return np.asarray(touches & leaning_rows(segment.timeline, trace.plan, trace.objects)[:, None])


def lasting_minimum(values: Array, hold: int) -> float:
    """The smallest value that is not exceeded for `hold` rows on end: the least of all running maxima."""
    if len(values) <= hold:
        return float(values.max())
    windows = np.lib.stride_tricks.sliding_window_view(values, hold)
    return float(windows.max(axis=1).min())


@dataclass(frozen=True)
class ContactAgreement(SegmentCheck):
    """Share of feet and times at which real and planned contact are the same."""

    name: ClassVar[str] = "contact_agreement"
    title: ClassVar[str] = "agreement of contact with C"

    def find(self, segment: Segment) -> Finding:
        rows, trace = segment.judged, segment.trace
        agree = (trace.normal_force[rows] > CONTACT_N) == trace.plan.contact[rows]
        return Finding(100.0 * float(agree.mean()), None, "%")
