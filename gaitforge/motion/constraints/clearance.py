"""Limbs keep clear of each other and of the trunk."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar

import numpy as np

from gaitforge.motion.bodies import BASE, Closest, LimbCapsule
from gaitforge.motion.family import Family
from gaitforge.motion.problem import Problem, kernel
from gaitforge.motion.trajectory import Trajectory
from gaitforge.robot.kinematics import limb_forward, parameter_size


@dataclass(frozen=True)
class Clearance(Family):
    """|p_a − p_b|² ≥ (r_a + r_b + margin + dip)² for material points that were found too close.

    Added by refinement, where the dense check found two bodies near each other: the points are those
    that were nearest then, so after another solve there may be new ones.  What the gap lost between the
    samples, the dip, is asked for on top at the sample.
    """

    name: ClassVar[str] = "clearance"
    unit: ClassVar[str] = "m²"
    enforced: ClassVar[str] = "at samples, for pairs of points that refinement found close"
    pairs: tuple[Closest, ...] = ()
    margin: float = 0.004
    """[m]"""

    def add_to(self, problem: Problem, trajectory: Trajectory) -> None:
        """One row a pair of points."""
        for pair in self.pairs:
            self._add_pair(problem, trajectory, pair)

    def _add_pair(self, problem: Problem, trajectory: Trajectory, pair: Closest) -> None:
        k = pair.sample % trajectory.grid.samples
        variables, parameters, shape = [], [], []
        for capsule, point in ((pair.first, pair.first_point), (pair.second, pair.second_point)):
            if capsule.limb in trajectory.moving:
                index = trajectory.joints[capsule.limb][k]
                variables.append(index)
                parameters += [trajectory.parameters[capsule.limb], point]
                shape.append((len(index), capsule.joint))
            else:
                parameters.append(_resting_point(trajectory, capsule, point))
                shape.append((0, BASE))
        if not variables:
            return
        floor = pair.first.radius + pair.second.radius + self.margin + pair.dip
        label = f"{pair.first.name}–{pair.second.name} at sample {k}"
        row = problem.add_rows(self.name, floor**2, np.inf, (1, 1), self.unit, [label])
        flat = np.concatenate(parameters)
        compiled = kernel(
            ("clear", *shape), sum(len(v) for v in variables), len(flat), partial(_instant, shapes=tuple(shape))
        )
        problem.add_term(self.name, compiled, np.concatenate(variables)[None], flat[None], row)


def _resting_point(trajectory: Trajectory, capsule: LimbCapsule, point: Any) -> Any:
    from gaitforge.robot.kinematics import evaluate_limb

    if capsule.limb == BASE:
        return point
    rows = trajectory.robot.joint_indices(trajectory.robot.limbs[capsule.limb])
    pose = evaluate_limb(trajectory.fixed_joints[None, rows], trajectory.parameters[capsule.limb])
    return pose.origins[0, capsule.joint] + pose.turns[0, capsule.joint] @ point


def _instant(v: Any, p: Any, shapes: tuple[tuple[int, int], ...]) -> Any:
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
    return ca.sumsqr(points[0] - points[1])
