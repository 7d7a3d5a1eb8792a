"""A certificate that a robot is too weak: no reachable stance lets its motors hold its weight."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gaitforge.errors import InfeasibleMotion
from gaitforge.motion.constraints.effort import Effort
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.trajectory import Discretisation
from gaitforge.robot.gravity import GRAVITY
from gaitforge.robot.kinematics import JOINT_PARAMETERS, evaluate_limb, limb_parameters
from gaitforge.robot.limbs import Limb
from gaitforge.robot.model import RobotModel
from gaitforge.robot.rotation import matrices

Array = NDArray[np.float64]
MOST_CELLS = 150_000
"""A proof that needs more cells is not looked for any further."""


def refuse_weak_modules(robot: RobotModel, grid: Discretisation, options: MotionOptions) -> None:
    """Raise `InfeasibleMotion` when the modules cannot hold the robot, under the bound that `effort` sets.

    The vertical forces of n feet in stance carry the weight, so some foot carries at least m g / n.  When
    for every limb in stance no joint position, tilt and height that the plan may use holds that force
    within the share of the effort limits, there is no plan.  Nothing is said without the family, whose
    vertical contact forces are assumed here, too.
    """
    shares = [family.share for family in options.constraints if isinstance(family, Effort)]
    if not shares:
        return
    for column in sorted({tuple(np.flatnonzero(c).tolist()) for c in grid.pattern.contact.T}, key=len):
        force = robot.mass * GRAVITY / len(column)
        if all(_too_weak(robot, robot.limbs[i], grid, options, min(shares), force) for i in column):
            names = [robot.limbs[i].name for i in column]
            raise InfeasibleMotion(
                f"the modules cannot hold {robot.name}: of {len(column)} feet in stance ({' '.join(names)}) one "
                f"carries at least {force:.1f} N, and no reachable posture of these limbs holds that within "
                f"{min(shares):.0%} of their effort limits",
                {
                    "families": ["effort"],
                    "limbs": names,
                    "advice": "stronger modules, less load, or a pattern with more feet on the ground",
                },
            )


def _too_weak(
    robot: RobotModel, limb: Limb, grid: Discretisation, options: MotionOptions, share: float, force: float
) -> bool:
    """Whether it is certain that the limb cannot hold a vertical force [N] in any stance that the plan may use."""
    body = grid.stances(robot).body[0]
    bounds = _Bounds.of(robot, limb, share, float(np.abs(body[1:]).sum()) + 2.0 * options.tilt_limit)
    rows = robot.joint_indices(limb)
    nominal = np.concatenate([body[1:], grid.stances(robot).joints[0, rows]])
    if bounds.strongest(nominal[None], np.zeros_like(nominal))[0] >= force:
        return False
    low = np.concatenate([body[1:] - options.tilt_limit, robot.lower[rows]])
    high = np.concatenate([body[1:] + options.tilt_limit, robot.upper[rows]])
    drop = body[0] - options.height_range, body[0] + options.height_range
    return _none_reaches(bounds, low, high, drop, force)


def _none_reaches(bounds: _Bounds, low: Array, high: Array, drop: tuple[float, float], force: float) -> bool:
    """Branch and bound over boxes of tilt and joint positions: True when no box can hold the force."""
    centres, half = 0.5 * (low + high)[None], 0.5 * (high - low)
    while len(centres):
        if len(centres) > MOST_CELLS:
            return False
        alive = bounds.may_stand(centres, half, drop) & (bounds.strongest(centres, half) >= force)
        centres = centres[alive]
        widest = int(np.argmax(half * bounds.weight))
        half = half.copy()
        half[widest] *= 0.5
        step = np.zeros(len(half))
        step[widest] = half[widest]
        centres = np.concatenate([centres - step, centres + step])
    return True


@dataclass(frozen=True, eq=False)
class _Bounds:
    """Levers and gravity torques of one limb over boxes of (roll, pitch, joints), with what they may change by."""

    geometry: Array
    limits: Array
    """(n,) [N m]"""
    axes: Array
    """(n, 3) in each joint's body"""
    masses: Array
    """(n,) [kg] and first moments (n, 3) [kg m] of each joint's body"""
    moments: Array
    reach: Array
    """(n,) [m] farthest that the foot can be from each joint"""
    first: Array
    """(3,) axis of the first joint in the base frame"""
    tilt: float
    """[rad] the base tilts no further"""
    hip: float
    """[m] of the first joint from the base's origin"""
    radius: float

    @staticmethod
    def of(robot: RobotModel, limb: Limb, share: float, tilt: float) -> _Bounds:
        """The bounds of a limb with a share of its effort limits, for tilts up to `tilt` [rad]."""
        geometry, count = limb_parameters(robot, limb), len(limb.joints)
        each = geometry[: JOINT_PARAMETERS * count].reshape(count, JOINT_PARAMETERS)
        links = np.append(np.linalg.norm(each[1:, 9:12], axis=1), np.linalg.norm(geometry[JOINT_PARAMETERS * count :]))
        return _Bounds(
            geometry,
            share * robot.effort[robot.joint_indices(limb)],
            each[:, 12:15],
            each[:, 15],
            each[:, 16:19],
            np.cumsum(links[::-1])[::-1],
            each[0, :9].reshape(3, 3, order="F") @ each[0, 12:15],
            tilt,
            float(np.linalg.norm(each[0, 9:12])),
            limb.foot.radius,
        )

    @property
    def weight(self) -> Array:
        """(2 + n,) [m] how far a radian of each dimension lifts the foot at most."""
        whole = self.hip + self.reach[0]
        return np.concatenate([[whole, whole], self.leaning * self.reach])

    @property
    def outermost(self) -> float:
        """[m] largest distance of a body's centre of mass from its joint."""
        return float((np.linalg.norm(self.moments, axis=1) / np.maximum(self.masses, 1e-9)).max())

    @property
    def leaning(self) -> Array:
        """(n,) sine of the largest angle between a joint's axis and the vertical; only the first is fixed in the base.

        A turn about the vertical changes no lever and no height.
        """
        most = np.ones(len(self.reach))
        across = float(np.linalg.norm(self.first[:2]))
        most[0] = min(1.0, across + self.tilt)
        return most

    def may_stand(self, centres: Array, half: Array, drop: tuple[float, float]) -> NDArray[np.bool_]:
        """(m,) whether the foot's lowest point may be `drop` [m] below the base somewhere in the box."""
        foot = evaluate_limb(centres[:, 2:], self.geometry).foot
        below = self.radius - (self._up(centres) * foot).sum(axis=1)
        slack = float(half @ self.weight)
        return np.asarray((below >= drop[0] - slack) & (below <= drop[1] + slack))

    def strongest(self, centres: Array, half: Array) -> Array:
        """(m,) [N] no vertical force above this is held anywhere in the box.

        |τ_k| ≤ limit with τ_k = G_k − F ℓ_k asks for F ≤ (limit + |G_k|) / |ℓ_k|; lever ℓ_k and gravity torque
        G_k change by at most the reach beyond the joint (times the weight there) per radian.
        """
        levers, torques = self._levers(centres)
        count, weights = len(self.limits), GRAVITY * np.cumsum(self.masses[::-1])[::-1]
        turned = np.array(
            [
                half[:2].sum() * self.reach[k]
                + sum(half[2 + j] * self.leaning[j] * self.reach[max(j, k)] for j in range(count))
                for k in range(count)
            ]
        )
        # no body is farther from a joint than the foot can be, or than its own centre of mass from the last joint
        far = np.maximum(self.reach, self.reach - self.reach[-1] + self.outermost)
        slack = turned * far / np.maximum(self.reach, 1e-9) * weights
        lever = np.maximum(np.abs(levers) - turned, 0.0)
        with np.errstate(divide="ignore"):
            return np.asarray(((self.limits + np.abs(torques) + slack) / lever).min(axis=1))

    def _levers(self, centres: Array) -> tuple[Array, Array]:
        """(m, n) levers of a vertical force at the foot [m], and gravity torques of the limb's own bodies [N m]."""
        pose, up = evaluate_limb(centres[:, 2:], self.geometry), self._up(centres)
        axes = np.einsum("mkij,kj->mki", pose.turns, self.axes)
        weighed = self.masses[:, None] * pose.origins + np.einsum("mkij,kj->mki", pose.turns, self.moments)
        beyond = np.cumsum(weighed[:, ::-1], axis=1)[:, ::-1]
        mass = np.cumsum(self.masses[::-1])[::-1]
        arm = pose.foot[:, None] - pose.origins
        own = beyond - mass[:, None] * pose.origins
        levers = (axes * np.cross(arm, up[:, None])).sum(axis=2)
        return levers, GRAVITY * (axes * np.cross(own, up[:, None])).sum(axis=2)

    def _up(self, centres: Array) -> Array:
        """(m, 3) the vertical in the base frame."""
        tilt = np.concatenate([centres[:, :2], np.zeros((len(centres), 1))], axis=1)
        return np.asarray(matrices(tilt)[:, 2])
