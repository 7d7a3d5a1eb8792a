"""Collision capsules of the limbs, and the distances between limbs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gaitforge.robot.kinematics import LimbPoses
from gaitforge.robot.model import RobotModel

Array = NDArray[np.float64]
BASE = -1


@dataclass(frozen=True, eq=False)
class LimbCapsule:
    """A capsule on the body that a limb's joint moves (limb and joint `BASE` on the base)."""

    limb: int
    joint: int
    a: Array
    """(3,) in the frame of the joint's body [m]"""
    b: Array
    radius: float
    name: str


class Closest(NamedTuple):
    """The nearest two material points of two capsules at one sample."""

    sample: int
    first: LimbCapsule
    second: LimbCapsule
    first_point: Array
    """(3,) in the frame of the first capsule's body"""
    second_point: Array
    gap: float
    """[m] between the surfaces"""


def limb_capsules(robot: RobotModel) -> tuple[LimbCapsule, ...]:
    """All capsules, in the frames of the bodies that joints move; tool joints at their nominal position."""
    import pinocchio

    owner = {link: i for i, limb in enumerate(robot.limbs) for link in limb.links}
    q = robot.configuration(np.zeros(6), robot.nominal.posture)
    data = robot.pin.createData()
    pinocchio.forwardKinematics(robot.pin, data, q)
    pinocchio.updateFramePlacements(robot.pin, data)
    found = []
    for capsule in robot.capsules:
        frame = robot.pin.getFrameId(capsule.link, pinocchio.FrameType.BODY)
        limb = owner.get(capsule.link, BASE)
        chain = [1] if limb == BASE else [robot.pin.getJointId(j) for j in robot.limbs[limb].joints]
        joint = robot.pin.frames[frame].parentJoint
        while joint not in chain:
            joint = robot.pin.parents[joint]
            if joint == 0:
                break
        if joint == 0:
            continue
        to_body = data.oMi[joint].actInv(data.oMf[frame])
        a, b = to_body.act(np.array(capsule.a)), to_body.act(np.array(capsule.b))
        at = BASE if limb == BASE else chain.index(joint)
        found.append(LimbCapsule(limb, at, a, b, capsule.radius, capsule.link))
    return tuple(found)


def ends_in_base(capsule: LimbCapsule, poses: dict[int, LimbPoses], samples: int) -> tuple[Array, Array]:
    """(n, 3) both ends of a capsule in the base frame."""
    if capsule.limb == BASE:
        return np.tile(capsule.a, (samples, 1)), np.tile(capsule.b, (samples, 1))
    pose = poses[capsule.limb]
    origin, turn = pose.origins[:, capsule.joint], pose.turns[:, capsule.joint]
    return origin + turn @ capsule.a, origin + turn @ capsule.b


def closest_pairs(capsules: tuple[LimbCapsule, ...], poses: dict[int, LimbPoses], margin: float) -> list[Closest]:
    """Every pair of capsules on different limbs (or limb and base, first bodies excepted) nearer than `margin`."""
    samples = len(next(iter(poses.values())).foot)
    ends = [ends_in_base(c, poses, samples) for c in capsules]
    found = []
    for i, first in enumerate(capsules):
        for j in range(i + 1, len(capsules)):
            second = capsules[j]
            if not _may_meet(first, second):
                continue
            reach = first.radius + second.radius + margin
            s, t, distance = segment_distance(*ends[i], *ends[j], bound=reach)
            for k in np.flatnonzero(distance < reach):
                p = first.a + s[k] * (first.b - first.a)
                q = second.a + t[k] * (second.b - second.a)
                gap = float(distance[k] - first.radius - second.radius)
                found.append(Closest(int(k), first, second, p, q, gap))
    return found


def _may_meet(first: LimbCapsule, second: LimbCapsule) -> bool:
    if first.limb == second.limb:
        return False
    if BASE in (first.limb, second.limb):
        return max(first.joint, second.joint) >= 1  # the first body of a limb sits at the base for good
    return True


def segment_distance(a: Array, b: Array, c: Array, d: Array, bound: float) -> tuple[Array, Array, Array]:
    """Nearest points a + s (b − a) and c + t (d − c) of segments (n, 3): s, t and the distance, each (n,).

    Pairs whose midpoints are farther apart than half lengths plus `bound` are left at an infinite distance.
    """
    n = len(a)
    s, t, distance = np.zeros(n), np.zeros(n), np.full(n, np.inf)
    u, v = b - a, d - c
    half = 0.5 * (np.linalg.norm(u, axis=1) + np.linalg.norm(v, axis=1))
    near = np.flatnonzero(np.linalg.norm(0.5 * (a + b - c - d), axis=1) < half + bound)
    if not len(near):
        return s, t, distance
    u, v, w = u[near], v[near], (a - c)[near]
    uu, vv = (u * u).sum(1) + 1e-15, (v * v).sum(1) + 1e-15
    uv, uw, vw = (u * v).sum(1), (u * w).sum(1), (v * w).sum(1)
    denominator = uu * vv - uv * uv
    sn = np.where(denominator > 1e-12, np.clip((uv * vw - vv * uw) / np.maximum(denominator, 1e-15), 0, 1), 0.5)
    tn = np.clip((uv * sn + vw) / vv, 0, 1)
    sn = np.clip((uv * tn - uw) / uu, 0, 1)
    tn = np.clip((uv * sn + vw) / vv, 0, 1)
    gap = w + sn[:, None] * u - tn[:, None] * v
    s[near], t[near], distance[near] = sn, tn, np.linalg.norm(gap, axis=1)
    return s, t, distance
