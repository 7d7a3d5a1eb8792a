"""Walking with a load: a body that goes steadily, and feet that clear the ground when joints give way."""

from __future__ import annotations

from dataclasses import replace

from gaitforge.motion.costs.pace import Pace
from gaitforge.motion.costs.smoothness import Smoothness
from gaitforge.motion.manipulation.ends import Facing
from gaitforge.motion.options import MotionOptions
from gaitforge.robot.model import RobotModel

STEADY = 5.0
"""How much more the acceleration of the base costs than in a gait without a load: what is held feels it, too."""
PACE = Pace(60.0)
"""The body of a crawl on four legs lags and hurries between its triangles: by −3 … 19 cm/s at 6.4 without this."""
HIGHER = 4.0 / 3.0
"""of the nominal step height: where joints give way under the load, by 2.5 mm in a hexapod with servos that give all
they have at 0.01 rad, a low step drags its foot over the ground when it lifts and lands"""


def steadied(options: MotionOptions, robot: RobotModel) -> MotionOptions:
    """The same options for a robot that carries; a step height or a pace that they ask for themselves stays."""
    height = HIGHER * robot.nominal.step_height if options.step_height is None else options.step_height
    slow = options.changed(Smoothness, lambda cost: replace(cost, position=STEADY * cost.position))
    paced = slow.costs if any(isinstance(cost, Pace) for cost in slow.costs) else (*slow.costs, PACE)
    return replace(slow, constraints=(*slow.constraints, Facing()), costs=paced, step_height=height)
