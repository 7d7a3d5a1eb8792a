"""Joint torques that hold the robot, with the weights of the CoP for contact forces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.family import Family
from gaitforge.motion.problem import Problem, kernel
from gaitforge.motion.trajectory import Trajectory
from gaitforge.robot.gravity import GRAVITY
from gaitforge.robot.kinematics import JOINT_PARAMETERS, LimbPoses, limb_forward, parameter_size, rpy_rotation
from gaitforge.robot.rotation import matrices


@dataclass(frozen=True)
class Effort(Family):
    """|τ_k| ≤ share · effort limit with τ = g(q) − Jᵀ f, f = (0, 0, m g w) below the foot.

    Quasi-static: gravity of the limb's own bodies and the vertical contact force of the CoP weight; what
    friction lets the feet do to each other (internal forces) and accelerations of the joints are left
    out, so keep a share for them.  The bound is written on τ / limit.
    """

    name: ClassVar[str] = "effort"
    unit: ClassVar[str] = "1"
    enforced: ClassVar[str] = "at samples, per contact set; without friction-induced internal forces"
    share: float = 0.8
    """of a joint's effort limit"""

    def add_to(self, problem: Problem, trajectory: Trajectory) -> None:
        """A row for every joint of a limb, at every sample and contact set."""
        for limb in trajectory.moving:
            loaded, free = _places(trajectory, limb)
            if loaded:
                self._add(problem, trajectory, limb, loaded, weighted=True)
            if free:
                self._add(problem, trajectory, limb, [(k, -1) for k in free], weighted=False)

    def _add(
        self, problem: Problem, trajectory: Trajectory, limb: int, places: list[tuple[int, int]], weighted: bool
    ) -> None:
        robot, joints = trajectory.robot, trajectory.joints[limb]
        at = np.array([k for k, _ in places])
        blocks = [trajectory.base[at, 3:5], joints[at]]
        if weighted:
            blocks.append(np.array([[index] for _, index in places], dtype=np.intp))
        count, rows = joints.shape[1], robot.joint_indices(robot.limbs[limb])
        parameters = np.concatenate(
            [
                trajectory.parameters[limb],
                [robot.limbs[limb].foot.radius, robot.mass * GRAVITY, GRAVITY],
                1.0 / robot.effort[rows],
            ]
        )
        labels = [(robot.limbs[limb].name, k) for k, _ in places]
        index = problem.add_rows(self.name, -self.share, self.share, (len(places), count), self.unit, labels)
        compiled = kernel(
            ("effort", count, weighted), 2 + count + weighted, parameter_size(count) + 3 + count, _instant(count)
        )
        problem.add_term(self.name, compiled, np.hstack(blocks), parameters, index)


def _places(trajectory: Trajectory, limb: int) -> tuple[list[tuple[int, int]], list[int]]:
    """(sample, index of the weight) where the limb is in a contact set; samples at which a set is without it."""
    loaded, free = [], []
    for k, feet, index in trajectory.weights:
        if limb in feet:
            loaded.append((k, int(index[feet.index(limb)])))
        else:
            free.append(k)
    return loaded, sorted(set(free))


def _instant(count: int) -> Any:
    def build(v: Any, p: Any) -> Any:
        import casadi as ca

        tilt, joints = v[:2], v[2 : 2 + count]
        weight = v[2 + count] if v.shape[0] > 2 + count else ca.SX(0)
        size = parameter_size(count)
        radius, weighs, gravity, scale = p[size], p[size + 1], p[size + 2], p[size + 3 :]
        torque = limb_torques(joints, p[:size], ca.vertcat(tilt, 0), radius, weighs * weight, gravity)
        return torque * scale

    return build


def limb_torques(joints: Any, geometry: Any, rpy: Any, radius: Any, force: Any, gravity: Any) -> Any:
    """(n,) motor torques [N m] that hold a limb against its own weight and a vertical force [N] below its foot.

    `joints` (n,) [rad], `geometry` by `limb_parameters`, `rpy` of the base (yaw has no say), `radius` [m] of the
    foot, `gravity` [m/s²]; symbolic.
    """
    import casadi as ca

    count = joints.shape[0]
    state = limb_forward(joints, geometry)
    up = rpy_rotation(rpy).T @ ca.vertcat(0, 0, 1)
    contact = state.foot - radius * up
    torques: list[Any] = [None] * count
    mass, moment = ca.SX(0), ca.SX.zeros(3)
    for k in reversed(range(count)):
        p = geometry[JOINT_PARAMETERS * k : JOINT_PARAMETERS * (k + 1)]
        mass = mass + p[15]
        moment = moment + p[15] * state.origins[k] + state.turns[k] @ p[16:19]
        axis = state.turns[k] @ p[12:15]
        pushed = ca.cross(contact - state.origins[k], force * up)
        weighed = ca.cross(moment - mass * state.origins[k], -gravity * up)
        torques[k] = -ca.dot(axis, pushed + weighed)
    return ca.vertcat(*torques)


def quasi_static_torques(
    poses: LimbPoses,
    geometry: NDArray[np.float64],
    rpy: NDArray[np.float64],
    radius: NDArray[np.float64],
    force: NDArray[np.float64],
) -> NDArray[np.float64]:
    """(L, m, n) [N m]: `limb_torques` of L limbs at m configurations, whose `poses` have L in front.

    `geometry` (L, p), `rpy` of the base (m, 3), `radius` (L,) [m], `force` (L, m) [N].
    """
    up, count = matrices(rpy)[:, 2], poses.origins.shape[2]
    contact, torques = poses.foot - radius[:, None, None] * up, np.empty(poses.origins.shape[:3])
    mass, moment = np.zeros((len(geometry), 1, 1)), np.zeros_like(contact)
    for k in reversed(range(count)):
        p = geometry[:, None, JOINT_PARAMETERS * k : JOINT_PARAMETERS * (k + 1)]  # (L, 1, …)
        origin, turn = poses.origins[:, :, k], poses.turns[:, :, k]
        mass = mass + p[..., 15:16]
        moment = moment + p[..., 15:16] * origin + (turn @ p[..., 16:19, None])[..., 0]
        lever = (contact - origin) * force[..., None] - GRAVITY * (moment - mass * origin)
        axis = (turn @ p[..., 12:15, None])[..., 0]
        torques[:, :, k] = -np.einsum("lmi,lmi->lm", np.cross(up, axis), lever)  # a · (l × u) = (u × a) · l
    return torques
