"""What contacts and joint servos are made of in MuJoCo."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Physics:
    """Numbers that a MuJoCo model is built with."""

    timestep: float
    """[s]"""
    iterations: int
    """[-] of the solver per step, at most"""
    full_effort_error: float
    """[rad] error at which a joint servo gives the module's whole effort"""
    servo_rate: float
    """[1/s] kp / kv of a joint servo"""
    friction: float
    """[-] coefficient of every pair"""
    torsional_friction: float
    """[m] torque about the normal of a contact with a movable object, per newton of normal force; 0 = none"""
    contact_time: float
    """[s] in which a contact's penetration decays (solref)"""
    contact_depth: float
    """[m] penetration over which a contact grows to its full stiffness (solimp)"""
    impedance_ratio: float
    """[-] stiffness of friction over that of the normal direction"""
