"""No slip: a spherical foot in stance moves by rolling only."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from gaitforge.motion.family import Family, carried
from gaitforge.motion.problem import Problem, kernel
from gaitforge.motion.trajectory import Trajectory
from gaitforge.robot.kinematics import limb_forward, parameter_size, rpy_rotation


@dataclass(frozen=True)
class Rolling(Family):
    """e_{j+1} − e_j = r (Δθ × ẑ), Δθ the rotation of the foot link from t_j to t_{j+1}.

    Δθ × ẑ is taken as ½ (A − Aᵀ) ẑ with A = R_{j+1} R_jᵀ, exact to third order in the angle.
    """

    name: ClassVar[str] = "rolling"
    unit: ClassVar[str] = "m"
    enforced: ClassVar[str] = "over whole intervals, from sample to sample"

    def add_to(self, problem: Problem, trajectory: Trajectory) -> None:
        """Two rows a stance foot and interval."""
        grid, robot = trajectory.grid, trajectory.robot
        for i in trajectory.moving:
            here = np.flatnonzero(grid.contact[:, i])
            if not len(here):
                continue
            following = (here + 1) % grid.samples
            joints = trajectory.joints[i]
            count = joints.shape[1]
            block = np.hstack([trajectory.base, joints, trajectory.feet[i]])
            compiled = kernel(("rolling", count), 2 * (9 + count), parameter_size(count) + 4, _instant)
            labels = [(robot.limbs[i].name, int(k)) for k in here]
            rows = problem.add_rows(self.name, 0.0, 0.0, (len(here), 2), self.unit, labels)
            parameters = np.concatenate([trajectory.parameters[i], grid.step, [robot.limbs[i].foot.radius]])
            problem.add_term(self.name, compiled, np.hstack([block[here], block[following]]), parameters, rows)


def _instant(v: Any, p: Any) -> Any:
    import casadi as ca

    half = v.shape[0] // 2
    count = half - 9
    geometry, frame, radius = p[: parameter_size(count)], p[-4:-1], p[-1]
    turn = rpy_rotation(ca.vertcat(0, 0, frame[2]))
    rotations, feet = [], []
    for part in (v[:half], v[half:]):
        state = limb_forward(part[6 : 6 + count], geometry)
        rotations.append(rpy_rotation(part[3:6]) @ state.rotation)
        feet.append(part[6 + count :])
    now, then = rotations[0], turn @ rotations[1]
    forth = then @ now[2, :].T
    back = now @ then[2, :].T
    travel = carried(feet[1], frame) - feet[0]
    return travel[:2] - radius * 0.5 * (forth - back)[:2]
