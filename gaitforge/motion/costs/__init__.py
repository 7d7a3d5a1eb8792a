r"""Cost families of the motion problem: Σ ∫ weight · residual² dt.

smoothness   joint accelerations and accelerations of the base
posture      joints near the nominal (locomotive limbs) or held posture
body         base height, roll, pitch, yaw and lateral drift
swing        foot heights near a smooth profile
sharing      CoP weights near equal shares
pace         the base at the commanded velocity; only where it is asked for, or a load is carried

Every weight is per second of motion, so that it does not depend on the number of samples.
"""

from __future__ import annotations

from gaitforge.motion.costs.body import Body
from gaitforge.motion.costs.pace import Pace
from gaitforge.motion.costs.posture import Posture
from gaitforge.motion.costs.sharing import Sharing
from gaitforge.motion.costs.smoothness import Smoothness
from gaitforge.motion.costs.swing import SwingProfile
from gaitforge.motion.family import Family

__all__ = ["Body", "Pace", "Posture", "Sharing", "Smoothness", "SwingProfile", "default_costs"]


def default_costs() -> tuple[Family, ...]:
    """The cost families of every motion problem."""
    return (Smoothness(), Posture(), Body(), Sharing(), SwingProfile())
