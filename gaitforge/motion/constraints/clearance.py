"""Limbs keep clear of each other and of the trunk."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.bodies import BASE, Closest, LimbCapsule
from gaitforge.motion.family import Family
from gaitforge.motion.problem import Problem, kernel
from gaitforge.motion.trajectory import Trajectory
from gaitforge.robot.kinematics import limb_forward, parameter_size


@dataclass(frozen=True)
class Clearance(Family):
    """|p_a − p_b| ≥ r_a + r_b + margin + dip − less for material points that were found too close.

    Added by refinement, where the dense check found two bodies near each other: the points are those
    that were nearest then, so after another solve there may be new ones.  What the gap lost between the
    samples, the dip, is asked for on top at the sample; bodies that keep enough as they are, or that a neighbour
    has put down nearer than the margin, are asked for less.  Written on squares; where two axes (nearly) crossed, the
    square has no gradient and no side to leave to, so n · (p_a − p_b) is bounded, n from hip to hip.
    """

    name: ClassVar[str] = "clearance"
    unit: ClassVar[str] = "m²"
    enforced: ClassVar[str] = "at samples, for pairs of points that refinement found close"
    pairs: tuple[Closest, ...] = ()
    margin: float = 0.004
    """[m]"""

    def add_to(self, problem: Problem, trajectory: Trajectory) -> None:
        """One row a pair of points."""
        alike: dict[tuple[Any, ...], list[_Place]] = {}
        for pair in self.pairs:
            place = _place(trajectory, pair, self.margin)
            if len(place.variables):
                alike.setdefault(place.shape, []).append(place)
        for shape, places in alike.items():
            crossed = shape[0]
            floors = np.array([[p.floor if crossed else p.floor**2] for p in places])
            unit = "m" if crossed else self.unit
            rows = problem.add_rows(self.name, floors, np.inf, floors.shape, unit, [p.label for p in places])
            variables, parameters = np.stack([p.variables for p in places]), np.stack([p.parameters for p in places])
            build = partial(_instant, crossed=crossed, shapes=shape[1:])
            compiled = kernel(("clear", *shape), variables.shape[1], parameters.shape[1], build)
            problem.add_term(self.name, compiled, variables, parameters, rows)


@dataclass(frozen=True, eq=False)
class _Place:
    """One pair of points of a problem."""

    shape: tuple[Any, ...]
    """(whether the axes crossed, (joints, joint) of both bodies)"""
    variables: NDArray[np.intp]
    parameters: NDArray[np.float64]
    floor: float
    label: str


def _place(trajectory: Trajectory, pair: Closest, margin: float) -> _Place:
    k = pair.sample % trajectory.grid.samples
    crossed = pair.side is not None
    variables, parameters, shape = [np.zeros(0, dtype=np.intp)], [], []
    for capsule, point in ((pair.first, pair.first_point), (pair.second, pair.second_point)):
        if capsule.limb in trajectory.moving:
            index = trajectory.joints[capsule.limb][k]
            variables.append(index)
            parameters += [trajectory.parameters[capsule.limb], point]
            shape.append((len(index), capsule.joint))
        else:
            parameters.append(_resting_point(trajectory, capsule, point))
            shape.append((0, BASE))
    if pair.side is not None:
        parameters.append(pair.side)
    floor = pair.first.radius + pair.second.radius + margin + pair.dip - pair.less
    label = f"{pair.first.name}–{pair.second.name} at sample {k}"
    return _Place((crossed, *shape), np.concatenate(variables), np.concatenate(parameters), floor, label)


def _resting_point(trajectory: Trajectory, capsule: LimbCapsule, point: Any) -> Any:
    from gaitforge.robot.kinematics import evaluate_limb

    if capsule.limb == BASE:
        return point
    rows = trajectory.robot.joint_indices(trajectory.robot.limbs[capsule.limb])
    pose = evaluate_limb(trajectory.fixed_joints[None, rows], trajectory.parameters[capsule.limb])
    return pose.origins[0, capsule.joint] + pose.turns[0, capsule.joint] @ point


def _instant(v: Any, p: Any, crossed: bool, shapes: tuple[tuple[int, int], ...]) -> Any:
    import casadi as ca

    points, at, used = [], 0, 0
    for count, joint in shapes:
        if not count:
            points.append(p[used : used + 3])
            used += 3
            continue
        size = parameter_size(count)
        state = limb_forward(v[at : at + count], p[used : used + size])
        points.append(state.origins[joint] + state.turns[joint] @ p[used + size : used + size + 3])
        at, used = at + count, used + size + 3
    apart = points[0] - points[1]
    return ca.dot(p[used : used + 3], apart) if crossed else ca.sumsqr(apart)
