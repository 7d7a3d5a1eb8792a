"""The checks of a run: each asks one question of one segment, in the order of `ALL`."""

from gaitforge.verify.checks.base import Finding, Segment, SegmentCheck
from gaitforge.verify.checks.body import BodyHeight, Fallen, Tilt
from gaitforge.verify.checks.contact import (
    ContactAgreement,
    LimpContacts,
    Slip,
    StaticMargin,
    UnplannedContacts,
    Unsupported,
)
from gaitforge.verify.checks.effort import CostOfTransport, JointTracking, PeakEffort, PeakSpeed
from gaitforge.verify.checks.limits import CheckLimits, SegmentLimits
from gaitforge.verify.checks.load import LoadAngle, LoadPlace
from gaitforge.verify.checks.tool import CameraPointing, LineOfSight
from gaitforge.verify.checks.travel import Heading, LateralDrift, Speed

ALL: tuple[SegmentCheck, ...] = (
    Fallen(),
    Speed(),
    Heading(),
    Tilt(),
    BodyHeight(),
    Slip(),
    UnplannedContacts(),
    StaticMargin(),
    CameraPointing(),
    LineOfSight(),
    LoadPlace(),
    LoadAngle(),
    JointTracking(),
    PeakEffort(),
    PeakSpeed(),
    ContactAgreement(),
    CostOfTransport(),
    LateralDrift(),
    LimpContacts(),
    Unsupported(),
)

__all__ = ["ALL", "CheckLimits", "Finding", "Segment", "SegmentCheck", "SegmentLimits"]
