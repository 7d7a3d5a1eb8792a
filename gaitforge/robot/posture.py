"""Postures for a robot whose file gives none: slightly bent legs to stand on, raised ones to hold."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitforge.robot.geometry import Array, turn
from gaitforge.robot.limbs import Foot, Limb
from gaitforge.robot.tree import Joint, RigidTree

BEND = 0.10
"""A straight leg is shortened by this share of its reach to stand."""
STRAIGHT = 0.97
"""A leg longer than this share of its reach counts as straight: it cannot move its foot outward."""
REACHED = 1e-3
"""[m] a foot this near to its goal is there."""
NEXT = 1.5
"""[rad] no other posture that reaches the goal is looked for when every joint stays within this."""
LIFT = 0.12
"""[m] a foot is held above its standing place."""


@dataclass(frozen=True, eq=False)
class Chain:
    """Joints from the base to a foot: forward kinematics of one limb."""

    joints: tuple[Joint, ...]
    foot: Foot

    @staticmethod
    def of(tree: RigidTree, foot: Foot) -> Chain:
        """The chain to a foot of a tree."""
        return Chain(tree.path(foot.link), foot)

    @property
    def lower(self) -> Array:
        """(n,) [rad]"""
        return np.array([j.lower for j in self.joints])

    @property
    def upper(self) -> Array:
        """(n,) [rad]"""
        return np.array([j.upper for j in self.joints])

    @property
    def rest(self) -> Array:
        """(n,) zero, or the limit next to it [rad]"""
        return np.clip(np.zeros(len(self.joints)), self.lower, self.upper)

    def tip(self, q: ArrayLike) -> Array:
        """(…, 3) centre of the foot sphere in the base frame [m] at joint positions (…, n) [rad]."""
        T, angles = np.eye(4), np.asarray(q, dtype=float)
        for k, joint in enumerate(self.joints):
            T = T @ joint.origin @ turn(joint.axis, angles[..., k])
        return np.asarray(T[..., :3, :3] @ self.foot.offset + T[..., :3, 3])

    def jacobian(self, q: Sequence[float] | Array) -> Array:
        """(3, n) ∂tip/∂q [m/rad]: each joint's axis × the way from the joint to the foot."""
        T, axes, origins = np.eye(4), [], []
        for joint, angle in zip(self.joints, q, strict=True):
            T = T @ joint.origin @ turn(joint.axis, float(angle))
            axes.append(T[:3, :3] @ joint.axis)
            origins.append(T[:3, 3])
        foot = T[:3, :3] @ self.foot.offset + T[:3, 3]
        return np.cross(np.array(axes), foot - np.array(origins)).T


def sampled(chain: Chain, count: int) -> Array:
    """(count, n) postures spread over the limits, the same ones every time: points of Halton (1960)."""
    points = np.stack([_mirrored(np.arange(count), base) for base in _primes(len(chain.joints))], axis=1)
    return np.asarray(chain.lower + points * (chain.upper - chain.lower))


def _mirrored(numbers: NDArray[np.intp], base: int) -> Array:
    """Digits of whole numbers mirrored at the point: 6 = 110 in base 2 becomes 0.011 = 3/8."""
    out, weight, left = np.zeros(len(numbers)), 1.0, numbers
    while left.any():
        weight /= base
        left, digit = np.divmod(left, base)
        out += weight * digit
    return out


def _primes(count: int) -> list[int]:
    found: list[int] = []
    candidate = 2
    while len(found) < count:
        if all(candidate % p for p in found):
            found.append(candidate)
        candidate += 1
    return found


def standing(tree: RigidTree, limbs: Sequence[Limb]) -> dict[str, float]:
    """Joint → angle [rad]: at rest, but a straight leg shortened by `BEND`, all feet at one height."""
    chains = [Chain.of(tree, x.foot) for x in limbs]
    rest = [c.tip(c.rest) for c in chains]
    bottoms = []
    for chain, point in zip(chains, rest, strict=True):
        length, span = _lengths(chain)
        bend = BEND * span if length > STRAIGHT * span else 0.0
        bottoms.append(float(point[2]) - chain.foot.radius + bend)
    ground = max(bottoms)
    angles: dict[str, float] = {}
    for point, chain in zip(rest, chains, strict=True):
        goal = np.array([point[0], point[1], ground + chain.foot.radius])
        q = chain.rest if abs(goal[2] - point[2]) < 1e-6 else reach(chain, goal, chain.rest)
        angles.update({j.name: float(a) for j, a in zip(chain.joints, q, strict=True)})
    return angles


def held(tree: RigidTree, limbs: Sequence[Limb], stand: dict[str, float]) -> dict[str, float]:
    """Joint → angle [rad]: each foot `LIFT` above where it stands."""
    angles = dict(stand)
    for limb in limbs:
        chain = Chain.of(tree, limb.foot)
        start = np.array([stand[j.name] for j in chain.joints])
        goal = chain.tip(start) + np.array([0.0, 0.0, LIFT])
        angles.update({j.name: float(a) for j, a in zip(chain.joints, reach(chain, goal, start), strict=True)})
    return angles


def reach(chain: Chain, goal: Array, near: Array) -> Array:
    """(n,) joint positions that bring the foot to `goal` (3,) [m] or as near as can be; of several, next to `near`."""
    from scipy.optimize import least_squares

    margin = 0.02 * (chain.upper - chain.lower)
    lower, upper = np.maximum(chain.lower + margin, near - np.pi), np.minimum(chain.upper - margin, near + np.pi)

    def residual(q: Array) -> Array:
        return np.concatenate([chain.tip(q) - goal, 1e-4 * (q - near)])

    def slope(q: Array) -> Array:
        return np.vstack([chain.jacobian(q), 1e-4 * np.eye(len(q))])

    def solved(start: Array) -> Array:
        found = least_squares(residual, np.clip(start, lower, upper), jac=slope, bounds=(lower, upper))
        return np.asarray(found.x)

    first = solved(near)
    if np.linalg.norm(chain.tip(first) - goal) < REACHED and np.abs(first - near).max() < NEXT:
        return first
    starts = (near + 0.25 * (np.clip(q, near - np.pi, near + np.pi) - near) for q in sampled(chain, 8))
    tries = [first, *map(solved, starts)]
    best = min(float(np.linalg.norm(chain.tip(q) - goal)) for q in tries)
    good = [q for q in tries if np.linalg.norm(chain.tip(q) - goal) < best + 1e-3]
    return np.asarray(min(good, key=lambda q: round(float(np.abs(q - near).sum()), 6)))


def _lengths(chain: Chain) -> tuple[float, float]:
    """Of the leg from its second joint on: distance of the foot at rest, and the farthest it can be [m]."""
    leg = Chain(chain.joints[min(2, len(chain.joints) - 1) :], chain.foot)
    lengths = np.linalg.norm(leg.tip(np.vstack([leg.rest, sampled(leg, 200)])), axis=1)
    return float(lengths[0]), float(lengths.max())
