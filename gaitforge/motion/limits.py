"""Certificates: what no motion plan can do, told without a solver."""

from __future__ import annotations

import numpy as np

from gaitforge.errors import InfeasibleMotion
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.trajectory import Discretisation
from gaitforge.robot.kinematics import JOINT_PARAMETERS, limb_parameters
from gaitforge.robot.limbs import Limb
from gaitforge.robot.model import RobotModel


def fastest_foot(robot: RobotModel, limb: Limb) -> float:
    """Upper bound of a foot's speed against the base [m/s]: Σ q̇_max · the farthest the foot can be from the joint."""
    parameters = limb_parameters(robot, limb)
    count = len(limb.joints)
    lengths = [
        float(np.linalg.norm(parameters[JOINT_PARAMETERS * i + 9 : JOINT_PARAMETERS * i + 12])) for i in range(count)
    ]
    lengths.append(float(np.linalg.norm(parameters[JOINT_PARAMETERS * count :])))
    rates = robot.velocity[robot.joint_indices(limb)]
    return float(sum(rate * sum(lengths[i + 1 :]) for i, rate in enumerate(rates)))


def longest_reach(robot: RobotModel, limb: Limb) -> float:
    """Upper bound of the distance between two places of a foot in the base frame [m]."""
    parameters = limb_parameters(robot, limb)
    count = len(limb.joints)
    lengths = [
        float(np.linalg.norm(parameters[JOINT_PARAMETERS * i + 9 : JOINT_PARAMETERS * i + 12])) for i in range(1, count)
    ]
    return 2.0 * (sum(lengths) + float(np.linalg.norm(parameters[JOINT_PARAMETERS * count :])))


def refuse_impossible_speed(robot: RobotModel, grid: Discretisation) -> None:
    """Raise `InfeasibleMotion` when some stance or swing needs more speed or reach than its limb can have.

    In stance a foot moves at the commanded speed against the base on average; in swing it makes the
    same way back in the time that is left.  Turning is left out: the bound speaks of translation.
    """
    speed, dt = grid.command.speed, grid.duration / grid.pattern.columns
    for limb, row in zip(robot.limbs, grid.pattern.contact, strict=True):
        if not row.any() or row.all() or not grid.cyclic:
            continue
        stance, swing = float(row.sum()) * dt, float((~row).sum()) * dt
        possible, reach = fastest_foot(robot, limb), longest_reach(robot, limb)
        needed = speed * max(1.0, stance / swing)
        way = speed * stance
        if needed > possible or way > reach:
            what = (
                f"needs its foot to move at {needed:.2f} m/s; its joints allow at most {possible:.2f} m/s"
                if needed > possible
                else f"would stay on the ground for {way:.2f} m of travel; it reaches at most {reach:.2f} m"
            )
            limit = min(possible / max(1.0, stance / swing), reach / stance)
            raise InfeasibleMotion(
                f"{speed:.3g} m/s is impossible: limb {limb.name} {what}",
                {
                    "families": ["joint_speed" if needed > possible else "reach"],
                    "limbs": [limb.name],
                    "advice": f"walk slower than {limit:.2f} m/s, or change the pattern or the duration",
                },
            )


def refuse_impossible_stance(robot: RobotModel, grid: Discretisation, options: MotionOptions) -> None:
    """Raise `InfeasibleMotion` when a limb that walks cannot reach the ground at the commanded body height.

    A foot is at most the sum of its links below the first joint, whatever the joints do; the body may be
    `height_range` lower than commanded and `tilt_limit` off its commanded tilt.
    """
    body = grid.stances(robot).body[0]
    tilt = float(np.abs(body[1:]).sum()) + 2.0 * options.tilt_limit
    for limb, row in zip(robot.limbs, grid.pattern.contact, strict=True):
        if not row.any():
            continue
        hip = limb_parameters(robot, limb)[9:12]
        lowest = body[0] - options.height_range + hip[2] - float(np.linalg.norm(hip)) * min(1.0, tilt)
        down = 0.5 * longest_reach(robot, limb) + limb.foot.radius
        if lowest > down:
            limit = body[0] - (lowest - down)
            raise InfeasibleMotion(
                f"a body height of {body[0]:.3g} m is impossible: limb {limb.name} reaches {down:.2f} m down from its "
                f"first joint, which is at least {lowest:.2f} m above the ground",
                {
                    "families": ["reach"],
                    "limbs": [limb.name],
                    "advice": f"command a body height below {limit:.2f} m",
                },
            )


def refuse_grounded_trunk(robot: RobotModel, grid: Discretisation, options: MotionOptions) -> None:
    """Raise `InfeasibleMotion` when the trunk lies in the ground wherever the commanded pose leaves it room.

    The mean height of its four lowest corners is the height of their centre, which no tilt lifts by more than
    the tilt times its distance from base_link; were it below the ground, so would be a corner.
    """
    if not robot.trunk:
        return
    from gaitforge.motion.trunk import trunk_corners

    height, roll, pitch = grid.stances(robot).body[0]
    centre = trunk_corners(robot).mean(axis=0)
    highest = height + options.height_range
    tilt = min(1.0, abs(roll) + abs(pitch) + 2.0 * options.tilt_limit)
    room = highest + max(0.0, centre[2]) + tilt * float(np.linalg.norm(centre[:2])) + min(0.0, centre[2]) * np.cos(tilt)
    if room < 0.0:
        limit = height - room
        raise InfeasibleMotion(
            f"a body height of {height:.3g} m is impossible: the trunk would lie {-1e3 * room:.0f} mm or more in the "
            "ground",
            {"families": ["trunk_height"], "limbs": [], "advice": f"command a body height above {limit:.2f} m"},
        )
