"""Collision capsules of the limbs, and the distances between limbs and to the trunk."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from gaitforge.robot.kinematics import LimbPoses, evaluate_limbs
from gaitforge.robot.model import RobotModel

Array = NDArray[np.float64]
Index = NDArray[np.intp]
BASE = -1
CROSSED = 0.3
"""Axes nearer to each other than this share of the radii cross: they have no side on which they could part"""


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
    """The nearest two material points of two bodies about one sample."""

    sample: int
    first: LimbCapsule
    second: LimbCapsule
    first_point: Array
    """(3,) in the frame of the first capsule's body"""
    second_point: Array
    gap: float
    """[m] between the surfaces, the smallest from half an interval before the sample to half an interval after"""
    dip: float = 0.0
    """[m] how much of that is lost between the samples"""
    side: Array | None = None
    """(3,) from the second limb to the first [unit vector, base frame], where the two axes (nearly) cross"""
    less: float = 0.0
    """[m] how much nearer they may stay than is asked of others"""


_known: WeakKeyDictionary[RobotModel, tuple[LimbCapsule, ...]] = WeakKeyDictionary()
_housings: WeakKeyDictionary[RobotModel, frozenset[tuple[LimbCapsule, LimbCapsule]]] = WeakKeyDictionary()


def limb_capsules(robot: RobotModel) -> tuple[LimbCapsule, ...]:
    """All capsules, in the frames of the bodies that joints move; tool joints at their nominal position."""
    if robot not in _known:
        _known[robot] = _limb_capsules(robot)
    return _known[robot]


def _limb_capsules(robot: RobotModel) -> tuple[LimbCapsule, ...]:
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


def ends_in_base(capsule: LimbCapsule, poses: dict[int, LimbPoses], times: int) -> tuple[Array, Array]:
    """(n, 3) both ends of a capsule in the base frame."""
    if capsule.limb == BASE:
        return np.tile(capsule.a, (times, 1)), np.tile(capsule.b, (times, 1))
    pose = poses[capsule.limb]
    origin, turn = pose.origins[:, capsule.joint], pose.turns[:, capsule.joint]
    return origin + turn @ capsule.a, origin + turn @ capsule.b


def swept(capsules: tuple[LimbCapsule, ...], poses: dict[int, LimbPoses]) -> tuple[Array, Array, Array]:
    """Ends a, b (C, n, 3) of the capsules in the base frame and their radii (C,) [m]."""
    times = len(next(iter(poses.values())).foot)
    out = np.empty((2, len(capsules), times, 3))
    for limb, joint, members, points in bodies_of(capsules):
        if limb != BASE:
            pose = poses[limb]
            turned = pose.turns[:, joint].reshape(-1, 3) @ points.T  # (3 n, ends)
            points = turned.reshape(times, 3, -1).transpose(2, 0, 1) + pose.origins[:, joint]
        else:
            points = np.broadcast_to(points[:, None], (len(points), times, 3))
        out[:, members] = points.reshape(-1, 2, times, 3).swapaxes(0, 1)
    return out[0], out[1], radii(capsules)


@lru_cache(maxsize=16)
def bodies_of(capsules: tuple[LimbCapsule, ...]) -> tuple[tuple[int, int, Index, Array], ...]:
    """Limb and joint of every body, which capsules it has, and both ends of each in its frame, one below the other."""
    members: dict[tuple[int, int], list[int]] = {}
    for i, c in enumerate(capsules):
        members.setdefault((c.limb, c.joint), []).append(i)
    return tuple(
        (*body, np.array(which), np.array([end for i in which for end in (capsules[i].a, capsules[i].b)]))
        for body, which in members.items()
    )


@lru_cache(maxsize=16)
def radii(capsules: tuple[LimbCapsule, ...]) -> Array:
    """(C,) [m]"""
    found = np.array([c.radius for c in capsules])
    found.setflags(write=False)
    return found


def closest_pairs(
    capsules: tuple[LimbCapsule, ...], poses: dict[int, LimbPoses], margin: float, per_interval: int = 1
) -> list[Closest]:
    """Every pair of capsules on different limbs (or limb and base, first bodies excepted) nearer than `margin` [m].

    `poses` at `per_interval` times an interval, the samples among them; a pair is given once a sample.
    """
    a, b, radius = swept(capsules, poses)
    first, second = _near_limbs(capsules, a, b, radius, margin)
    reach = radius[first] + radius[second] + margin
    middle, half = 0.5 * (a + b), 0.5 * np.linalg.norm(b[:, 0] - a[:, 0], axis=1)
    apart = middle[first] - middle[second]
    near = np.einsum("pni,pni->pn", apart, apart) < ((half[first] + half[second] + reach)[:, None]) ** 2
    pair, k = np.nonzero(near)
    i, j = first[pair], second[pair]
    s, t, distance = segment_distance(a[i, k], b[i, k], a[j, k], b[j, k])
    gap = np.full(near.shape, np.inf)
    gap[pair, k] = distance - radius[i] - radius[j]
    share = np.zeros((*near.shape, 2))
    share[pair, k, 0], share[pair, k, 1] = s, t
    return [
        _closest(capsules[first[p]], capsules[second[p]], share[p, at], worst, at_sample, sample, poses)
        for p, sample, at, worst, at_sample in hits(gap, margin, per_interval)
    ]


def housings(robot: RobotModel) -> frozenset[tuple[LimbCapsule, LimbCapsule]]:
    """Pairs of first bodies of two limbs that overlap where the robot stands: hips side by side, drawn wide."""
    if robot not in _housings:
        poses = evaluate_limbs(robot, np.array(robot.nominal.posture, dtype=float)[None])
        met = closest_pairs(limb_capsules(robot), poses, 0.0)
        _housings[robot] = frozenset((c.first, c.second) for c in met if c.first.joint == c.second.joint == 0)
    return _housings[robot]


def hits(gap: Array, margin: float, per_interval: int) -> list[tuple[int, int, int, float, float]]:
    """(row, sample, time of the smallest gap about it, that gap, the gap at the sample) where the gap is < `margin`.

    `gap` (P, n) [m] at `per_interval` times an interval; infinite where it is known to be larger than `margin`.
    """
    times = gap.shape[1]
    half = per_interval // 2
    found = []
    for p in np.flatnonzero((gap < margin).any(axis=1)):
        for sample in range((times - 1) // per_interval + 1):
            at = sample * per_interval
            begin, end = max(0, at - half), min(times, at + half + 1)
            worst = begin + int(gap[p, begin:end].argmin())
            if gap[p, worst] < margin:
                found.append((int(p), sample, worst, float(gap[p, worst]), float(min(gap[p, at], margin))))
    return found


def _closest(
    first: LimbCapsule, second: LimbCapsule, share: Array, gap: float, at_sample: float, sample: int,
    poses: dict[int, LimbPoses],
) -> Closest:  # fmt: skip
    p, q = (c.a + s * (c.b - c.a) for c, s in ((first, share[0]), (second, share[1])))
    reach = first.radius + second.radius
    side = None
    if gap + reach < CROSSED * reach and BASE not in (first.limb, second.limb):
        hips = poses[first.limb].origins[0, 0] - poses[second.limb].origins[0, 0]
        side = hips / np.linalg.norm(hips)
    return Closest(sample, first, second, p, q, gap, max(0.0, at_sample - gap), side)


def _near_limbs(
    capsules: tuple[LimbCapsule, ...], a: Array, b: Array, radius: Array, margin: float
) -> tuple[Index, Index]:
    """Pairs of capsules (two index vectors) on limbs whose bounding boxes come nearer than `margin` at some time."""
    first, second = _may_meet(capsules)
    low = np.minimum(a, b) - radius[:, None, None]
    high = np.maximum(a, b) + radius[:, None, None]
    owner = np.array([c.limb for c in capsules])
    names, limb = np.unique(owner, return_inverse=True)
    lower = np.array([low[owner == n].min(axis=0) for n in names])  # (limbs, n, 3)
    upper = np.array([high[owner == n].max(axis=0) for n in names])
    between = np.maximum(lower[:, None] - upper[None], lower[None] - upper[:, None]).max(axis=-1)
    meet = (between < margin).any(axis=-1)[limb[first], limb[second]]
    return first[meet], second[meet]


@lru_cache(maxsize=16)
def _may_meet(capsules: tuple[LimbCapsule, ...]) -> tuple[Index, Index]:
    """Pairs on different limbs; the first body of a limb sits at the base for good."""
    limb, joint = np.array([c.limb for c in capsules]), np.array([c.joint for c in capsules])
    first, second = np.triu_indices(len(capsules), 1)
    base = (limb[first] == BASE) | (limb[second] == BASE)
    keep = (limb[first] != limb[second]) & (~base | (np.maximum(joint[first], joint[second]) >= 1))
    return first[keep], second[keep]


def segment_distance(a: Array, b: Array, c: Array, d: Array) -> tuple[Array, Array, Array]:
    """Nearest points a + s (b − a) and c + t (d − c) of segments (n, 3): s, t and the distance, each (n,)."""
    u, v, w = b - a, d - c, a - c
    uu, vv = (np.einsum("ni,ni->n", x, x) + 1e-15 for x in (u, v))
    uv, uw, vw = (np.einsum("ni,ni->n", x, y) for x, y in ((u, v), (u, w), (v, w)))
    denominator = uu * vv - uv * uv
    s = np.where(denominator > 1e-12, np.clip((uv * vw - vv * uw) / np.maximum(denominator, 1e-15), 0, 1), 0.5)
    t = np.clip((uv * s + vw) / vv, 0, 1)
    s = np.clip((uv * t - uw) / uu, 0, 1)
    t = np.clip((uv * s + vw) / vv, 0, 1)
    gap = w + s[:, None] * u - t[:, None] * v
    return s, t, np.linalg.norm(gap, axis=1)
