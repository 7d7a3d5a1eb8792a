"""How near the limbs come to the trunk, whose shapes are boxes."""

from __future__ import annotations

from itertools import product
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.bodies import BASE, Closest, LimbCapsule, hits, limb_capsules, swept
from gaitforge.robot.kinematics import LimbPoses, evaluate_limbs
from gaitforge.robot.model import Box, RobotModel
from gaitforge.robot.rotation import matrices

Array = NDArray[np.float64]
HALVINGS = 24
"""of the interval in which the nearest point of a capsule's axis lies: 1e-5 of its length"""
JOINED_M = 0.005
"""[m] a body that is nearer than this to the trunk in the nominal posture is one of its joint's own housings"""
STANDING_M = 0.1
"""[m] gaps of the nominal posture are known up to here"""

_known: WeakKeyDictionary[RobotModel, Array] = WeakKeyDictionary()


def closest_to_trunk(
    robot: RobotModel, poses: dict[int, LimbPoses], margin: float, per_interval: int = 1
) -> list[Closest]:
    """Every body of a limb nearer to a shape of the trunk than `margin` [m], as `closest_pairs` tells of two limbs.

    Only what is nearer than half of its gap in the nominal posture: nobody can ask for more than there is.
    """
    capsules = limb_capsules(robot)
    a, b, radius = swept(capsules, poses)
    found = []
    for box, members, standing in _near_boxes(robot, a, b, radius, margin):
        gap, share = gaps(box, a[members], b[members], radius[members], margin)
        gap[gap > 0.5 * standing[:, None]] = np.inf
        for p, sample, at, worst, at_sample in hits(gap, margin, per_interval):
            capsule, s, c = capsules[members[p]], share[p, at], members[p]
            touched = nearest_on(box, a[c, at] + s * (b[c, at] - a[c, at]))
            trunk = LimbCapsule(BASE, BASE, touched, touched, 0.0, robot.base_link)
            own = capsule.a + s * (capsule.b - capsule.a)
            found.append(Closest(sample, capsule, trunk, own, touched, worst, max(0.0, at_sample - worst)))
    return found


def gaps(box: Box, a: Array, b: Array, radius: Array, margin: float) -> tuple[Array, Array]:
    """(C, n) gaps [m] between capsules (ends a, b: (C, n, 3), radius (C,)) and a box, and where on the axis (0 … 1).

    The signed distance to a convex body is convex along a segment, so thirds of it are cut away.  Gaps
    known to be larger than `margin` are infinite.
    """
    half = 0.5 * np.linalg.norm(b[:, 0] - a[:, 0], axis=1)
    rough = signed_distance(box, 0.5 * (a + b)) - (half + radius)[:, None]
    c, k = np.nonzero(rough < margin)
    start, along = a[c, k], b[c, k] - a[c, k]
    low, high = np.zeros(len(c)), np.ones(len(c))
    for _ in range(HALVINGS):
        one, two = low + (high - low) / 3, high - (high - low) / 3
        left = signed_distance(box, start + one[:, None] * along) < signed_distance(box, start + two[:, None] * along)
        low, high = np.where(left, low, one), np.where(left, two, high)
    gap, share = np.full(rough.shape, np.inf), np.zeros(rough.shape)
    share[c, k] = 0.5 * (low + high)
    gap[c, k] = signed_distance(box, start + share[c, k][:, None] * along) - radius[c]
    return gap, share


def signed_distance(box: Box, points: Array) -> Array:
    """(…) distance of points (…, 3) in the base frame from the surface of a box, negative inside [m]."""
    beyond = np.abs((points - box.center) @ np.array(box.rotation)) - 0.5 * np.array(box.size)
    outside = np.maximum(beyond, 0.0)
    return np.asarray(np.sqrt(np.einsum("...i,...i->...", outside, outside)) + np.minimum(beyond.max(axis=-1), 0.0))


def nearest_on(box: Box, point: Array) -> Array:
    """(3,) the point of the box's surface that is nearest to a point in the base frame."""
    turn, half = np.array(box.rotation), 0.5 * np.array(box.size)
    inside = (point - box.center) @ turn
    nearest = np.clip(inside, -half, half)
    if (np.abs(inside) < half).all():
        axis = int(np.argmin(half - np.abs(inside)))
        nearest[axis] = np.copysign(half[axis], inside[axis])
    return np.asarray(turn @ nearest + box.center)


def _near_boxes(
    robot: RobotModel, a: Array, b: Array, radius: Array, margin: float
) -> list[tuple[Box, NDArray[np.intp], Array]]:
    """Shapes of the trunk, the capsules that may come nearer than `margin` to any of them, and their standing gaps."""
    if not robot.trunk:
        return []
    corners = np.array([box_corners(box) for box in robot.trunk]).reshape(-1, 3)
    reach = (radius + margin)[:, None, None]
    low, high = np.minimum(a, b) - reach, np.maximum(a, b) + reach
    near = ((low < corners.max(axis=0)) & (high > corners.min(axis=0))).all(axis=2).any(axis=1)
    found = []
    for box, standing in zip(robot.trunk, _standing(robot), strict=True):
        members = np.flatnonzero(near & (standing > JOINED_M))
        if len(members):
            found.append((box, members, standing[members]))
    return found


def trunk_corners(robot: RobotModel) -> Array:
    """(4, 3) corners of the trunk's largest shape in the base frame, the four that are lowest while it is level [m]."""
    largest = max(robot.trunk, key=lambda box: float(np.prod(box.size)))
    lowest = box_corners(largest)
    return np.asarray(lowest[np.argsort(lowest[:, 2])[:4]])


def trunk_height(robot: RobotModel, base_poses: Array) -> float:
    """[m] how low any corner of the trunk comes along base poses (n, 6); inf without shapes."""
    if not robot.trunk:
        return float("inf")
    corners = np.array([box_corners(box) for box in robot.trunk]).reshape(-1, 3)
    up = matrices(base_poses[:, 3:6])[:, 2]  # (n, 3)
    return float((base_poses[:, 2:3] + up @ corners.T).min())


def box_corners(box: Box) -> Array:
    """(8, 3) in the base frame [m]."""
    signs = np.array(list(product((-0.5, 0.5), repeat=3)))
    return np.asarray((signs * box.size) @ np.array(box.rotation).T + box.center)


def _standing(robot: RobotModel) -> Array:
    """(boxes, capsules) gaps in the nominal posture [m]; 0 for the first body of each limb, fixed to the trunk."""
    if robot not in _known:
        capsules = limb_capsules(robot)
        a, b, radius = swept(capsules, evaluate_limbs(robot, robot.nominal.posture[None]))
        free = np.array([c.limb != BASE and c.joint >= 1 for c in capsules])
        standing = np.array([gaps(box, a, b, radius, STANDING_M)[0][:, 0] for box in robot.trunk])
        _known[robot] = np.where(free, standing, 0.0)
    return _known[robot]
