"""No slip: a spherical foot in stance moves by rolling only."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from gaitforge.motion.family import Family, carried
from gaitforge.motion.problem import Problem, kernel
from gaitforge.motion.trajectory import Trajectory
from gaitforge.motion.turning import RPY, chain_axes, first, place, second
from gaitforge.robot.kinematics import joint_axes, limb_forward, parameter_size, rpy_rotation


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
        for group in trajectory.alike:
            member, here = np.nonzero(grid.contact[:, group.limbs].T)
            if not len(here):
                continue
            following = (here + 1) % grid.samples
            count = group.rows.shape[1]
            variables = np.hstack(
                [
                    block
                    for k in (here, following)
                    for block in (trajectory.base[k], group.joints[member, k], group.feet[member, k])
                ]
            )
            compiled = kernel(("rolling", count), 2 * (9 + count), parameter_size(count) + 4, _instant, _derivatives)
            names = [robot.limbs[i].name for i in group.limbs]
            labels = [(names[i], k) for i, k in zip(member.tolist(), here.tolist(), strict=True)]
            rows = problem.add_rows(self.name, 0.0, 0.0, (len(here), 2), self.unit, labels)
            radii = np.array([[robot.limbs[i].foot.radius] for i in group.limbs])
            parameters = np.hstack([group.parameters, np.tile(grid.step, (len(radii), 1)), radii])[member]
            problem.add_term(self.name, compiled, variables, parameters, rows)


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


def _derivatives(v: Any, p: Any, multiplier: Any) -> tuple[Any, Any]:
    """Two chains of turns, R_j and R_j+1: forth = A ẑ is a vector that the later one turns, back = Aᵀ ẑ the earlier.

    A and Aᵀ change with the other chain too: ∂(A ẑ)/∂θ = A (ẑ × a) and ∂²(A ẑ)/∂θ_i∂θ_j = A (a_j × (a_i × ẑ))
    for axes of R_j, i ≤ j.
    """
    import casadi as ca

    half = v.shape[0] // 2
    count = half - 9
    geometry, frame, radius = p[: parameter_size(count)], p[-4:-1], p[-1]
    rotations, chains = [], []
    for k, part in enumerate((v[:half], v[half:])):
        state = limb_forward(part[6 : 6 + count], geometry)
        base = rpy_rotation(part[3:6])
        base = rpy_rotation(ca.vertcat(0, 0, frame[2])) @ base if k else base
        rotations.append(base @ state.rotation)
        chains.append([base @ a for a in chain_axes(part[3:6], state, joint_axes(geometry, count))])
    turn = rotations[1] @ rotations[0].T
    up, size = ca.SX([0, 0, 1]), len(chains[0])
    force = ca.vertcat(-0.5 * radius * multiplier, 0)
    places = [[*RPY, *range(6, 6 + count)], [half + k for k in (*RPY, *range(6, 6 + count))]]
    jacobian, hessian = ca.SX(2, 2 * half), ca.SX(2 * half, 2 * half)
    # forth belongs to the later chain (own = 1), back to the earlier one with the opposite sign
    for own, sign, matrix in ((1, 1, turn), (0, -1, turn.T)):
        mine, others = chains[own], chains[1 - own]
        moved = first(mine, [matrix[:, 2]] * size)
        lean = [ca.cross(up, a) for a in others]
        swept = [matrix @ tilt for tilt in lean]
        for i in range(size):
            jacobian[:, places[own][i]] += -0.5 * radius * sign * moved[i][:2]
            jacobian[:, places[1 - own][i]] += -0.5 * radius * sign * swept[i][:2]
        place(hessian, places[own], second(mine, moved, sign * force))
        pulls = [ca.cross(matrix.T @ (sign * force), a) for a in others]
        there = [[-ca.dot(pulls[j], lean[i]) for j in range(i, size)] for i in range(size)]
        place(hessian, places[1 - own], there)
        for i, a in enumerate(mine):
            pull = ca.cross(sign * force, a)
            for j in range(size):
                row, column = sorted((places[own][i], places[1 - own][j]))
                hessian[row, column] += ca.dot(pull, swept[j])
    c, s = ca.cos(frame[2]), ca.sin(frame[2])
    jacobian[:, half - 3 : half - 1] = -ca.SX.eye(2)
    jacobian[:, 2 * half - 3 : 2 * half - 1] = ca.vertcat(ca.horzcat(c, -s), ca.horzcat(s, c))
    return jacobian, hessian
