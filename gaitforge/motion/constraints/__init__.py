r"""Constraint families of the motion problem: l ≤ c(x) ≤ u.

kinematics   FK(q, base) = e, CoM(q, base) = x
rolling      e_{j+1} − e_j = r (Δθ × ẑ) while a foot is in stance
balance      CoP = x − z / (g + z̈) ẍ = Σ w e, Σ w = 1
progress     the body advances by at least a share of the commanded travel (open segments)
joint_speed  |q_{j+1} − q_j| ≤ share · q̇_max dt
effort       |τ_k| ≤ share · effort limit, τ = g(q) − Jᵀ f
clearance    |p_a − p_b| ≥ r_a + r_b + margin for bodies of neighbouring limbs
limb_height  z + e_z · R p ≥ radius + margin for points of limbs other than feet

Joint positions, the heights of feet and base, and tilt are bounds on variables (see `trajectory`).
"""

from __future__ import annotations

from gaitforge.motion.constraints.balance import Balance
from gaitforge.motion.constraints.clearance import Clearance
from gaitforge.motion.constraints.effort import Effort
from gaitforge.motion.constraints.joint_speed import JointSpeed
from gaitforge.motion.constraints.kinematics import Kinematics
from gaitforge.motion.constraints.progress import Progress
from gaitforge.motion.constraints.rolling import Rolling
from gaitforge.motion.family import Family

__all__ = ["Balance", "Clearance", "Effort", "JointSpeed", "Kinematics", "Progress", "Rolling", "default_constraints"]


def default_constraints() -> tuple[Family, ...]:
    """The constraint families of every motion problem; refinement adds joint speeds and clearances."""
    return (Kinematics(), Rolling(), Balance(), Progress())
