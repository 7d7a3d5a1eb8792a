"""What is still good enough, per kind of segment."""

from __future__ import annotations

from dataclasses import dataclass, field

from gaitforge.motion.plan import Kind


@dataclass(frozen=True)
class SegmentLimits:
    """Limits of one kind of segment; None = reported, not judged."""

    speed_percent: float = 5.0
    """[%] of the planned speed that may be missing (in a gait: or too much)"""
    heading_deg: float = 3.0
    """[deg] of yaw against plan; in a gait [deg/m]"""
    tilt_deg: float = 4.0
    """[deg] between planned and measured vertical axis of the trunk"""
    body_height_mm: float = 20.0
    """[mm] of base_link against plan"""
    slip_mm: float = 10.0
    """[mm] path of a foot's contact point in one stance, rolling taken out"""
    static_margin_mm: float | None = 0.0
    """[mm] that the centre of mass is to be inside the polygon of real contacts, at least"""
    camera_pointing_deg: float | None = None
    """[deg] between optical axis and target, open loop"""
    closed_pointing_deg: float | None = None
    """[deg] the same where tool limbs are aimed again from the measured pose of the body"""
    laden_margin_mm: float | None = None
    """[mm] the same while a load is carried"""
    load_place_mm: float = 20.0
    """[mm] of a load in the grasp, or in reach, against its planned place relative to the body"""
    load_angle_deg: float = 10.0
    """[deg] … against its planned orientation"""


@dataclass(frozen=True)
class CheckLimits:
    """The table of limits (DESIGN of the project, verification): gaits, transitions and stands."""

    gait: SegmentLimits = SegmentLimits(
        heading_deg=2.0,
        tilt_deg=2.0,
        body_height_mm=10.0,
        slip_mm=5.0,
        camera_pointing_deg=2.5,
        closed_pointing_deg=1.0,
        laden_margin_mm=10.0,
    )
    transition: SegmentLimits = field(default_factory=SegmentLimits)
    stand: SegmentLimits = field(default_factory=SegmentLimits)
    heading_from_m: float = 0.25
    """[m] gaits shorter than this are not judged by their heading: a degree of yaw is then noise"""
    distance_floor_mm: float = 2.0
    """[mm] a segment may always fall this short: what a robot gives when its joints take up load"""
    margin_hold_s: float = 0.025
    """[s] a static margin counts when it lasts this long: feet that change over do so within a few steps"""
    effort_window_s: float = 0.025
    """[s] over which torques are averaged before their peak is taken: rigid impacts last a step"""
    fallen_deg: float = 20.0
    """[deg] tilt of a robot that has fallen"""

    def of(self, kind: Kind) -> SegmentLimits:
        """Limits of a kind of segment."""
        limits: SegmentLimits = getattr(self, kind)
        return limits
