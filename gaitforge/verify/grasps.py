"""Loads in a simulated run: who may touch them, what they weigh on the robot, how far they are from their place."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.timeline import Timeline, TimelineSamples
from gaitforge.robot.model import RobotModel
from gaitforge.robot.rotation import matrices, matrices_of_quaternions
from gaitforge.task.scene import Scene

Array = NDArray[np.float64]


def grasp_contacts(robot: RobotModel, timeline: Timeline, plan: TimelineSamples, scene: Scene) -> NDArray[np.bool_]:
    """(n, n_F, n_objects) is the tip of a limb to touch an object."""
    names = [item.name for item in scene.objects]
    allowed = np.zeros((len(plan.times), len(robot.limbs), len(names)), dtype=bool)
    for index, entry in enumerate(timeline.entries):
        for holding in entry.plan.holdings:
            for limb in holding.limbs:
                allowed[plan.segment == index, robot.limb_names.index(limb), names.index(holding.object)] = True
    return allowed


def laden_com(
    robot: RobotModel, timeline: Timeline, plan: TimelineSamples, com: Array, objects: dict[str, Array]
) -> Array:
    """(n, 3) centre of mass of the robot, at `com` (n, 3), and of what it bears, where that really is.

    A load in the grasp that stands on something is none of it: tips that press on it, by whatever, leave the feet
    a robot that has to stand if the load gives way.  Of a load that is lifted or lowered the feet bear the share λ
    with their centre of pressure at c_λ = (M c + λ m b) / (M + λ m), between the robot's own centre of mass c (M)
    and the common one, and the load's mass m counts from the moment that it is off what it stood on.
    """
    moment, mass = robot.mass * com, np.full(len(com), robot.mass)
    for index, entry in enumerate(timeline.entries):
        rows = np.flatnonzero(plan.segment == index)
        for holding in entry.plan.holdings:
            places = objects[holding.object][rows, :3]
            borne = holding.mass * holding.borne(places[:, 2])
            moment[rows] += borne[:, None] * places
            mass[rows] += borne
    return np.asarray(moment / mass[:, None])


def leaning_rows(timeline: Timeline, plan: TimelineSamples, objects: dict[str, Array]) -> NDArray[np.bool_]:
    """(n,) do tips touch a load that stands on something: by whatever they press on it, feet bear less or more."""
    found = np.zeros(len(plan.times), dtype=bool)
    for index, entry in enumerate(timeline.entries):
        rows = np.flatnonzero(plan.segment == index)
        for holding in entry.plan.holdings:
            if holding.limbs:
                found[rows] |= ~holding.borne(objects[holding.object][rows, 2])
    return found


def load_errors(base_poses: Array, measured: Array, planned: Array) -> tuple[Array, Array]:
    """(n,) distance [m] and angle [rad] between a load and its planned place relative to the body, NaN without plan.

    base_poses (n, 6) measured, measured (n, 7) pose of the load in the world, planned (n, 6) in base_link.
    """
    R = matrices(base_poses[:, 3:])
    place = np.einsum("nji,nj->ni", R, measured[:, :3] - base_poses[:, :3])
    turn = np.einsum("nji,njk->nik", R, matrices_of_quaternions(measured[:, 3:]))
    missed = np.einsum("nji,njk->nik", matrices(planned[:, 3:]), turn)
    cosine = 0.5 * (np.trace(missed, axis1=1, axis2=2) - 1.0)
    return np.linalg.norm(place - planned[:, :3], axis=1), np.arccos(np.clip(cosine, -1.0, 1.0))
