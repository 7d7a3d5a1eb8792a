"""The least that a plan asks of its motors, whatever the feet do to each other through friction."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.constraints.effort import Effort
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import MotionPlan
from gaitforge.robot.model import RobotModel
from gaitforge.task.roles import Failed

Array = NDArray[np.float64]
FRICTION = 0.35
"""[-] half of what the simulators' pyramid grips with: a stance that needs more of it slides sooner or later"""


def least_strain(robot: RobotModel, plan: MotionPlan, friction: float = FRICTION) -> float:
    """max over intervals of min over contact forces of max over joints |τ| / limit [-]; inf without equilibrium.

    At the start of every interval τ = g(q) − Σ Jᵀ f holds the robot at rest with any f inside the friction pyramid of
    the feet in stance: a linear program of three forces a foot.  Above 1 no distribution of forces can be held, where
    `effort_ratios` judges the one distribution that the plan's weights name.  Limp joints are left out.
    """
    robot = robot.carrying(*plan.loads)
    columns = np.repeat(np.arange(plan.pattern.columns), plan.samples_per_column)
    worst = 0.0
    for k, column in enumerate(columns):
        feet = np.flatnonzero(plan.pattern.contact[:, column]).tolist()
        if not feet:
            return float("inf")
        gravity, pushes = _equilibrium(robot, plan, k, feet)
        worst = max(worst, _least(gravity, pushes, robot.effort, _driven(robot, plan), friction))
    return worst


def strain_of(robot: RobotModel, plan: MotionPlan) -> float:
    """The plan's own `effort_ratio`, or `least_strain` where that is above 1 [-]."""
    planned = float(plan.report.details.get("effort_ratio", 0.0))
    return planned if planned <= 1.0 else least_strain(robot, plan)


def bounded(options: MotionOptions, share: float) -> MotionOptions:
    """The options with quasi-static efforts of at most `share` of the motors' limits, or less if they say so."""
    others = tuple(f for f in options.constraints if not isinstance(f, Effort))
    asked = (f.share for f in options.constraints if isinstance(f, Effort))
    return replace(options, constraints=(*others, Effort(min([share, *asked]))))


def _driven(robot: RobotModel, plan: MotionPlan) -> NDArray[np.intp]:
    """Joints that have a motor."""
    limp = [n for n, role in plan.roles.items() if isinstance(role, Failed) and role.mode == "limp"]
    off = [j for n in limp for j in robot.joint_indices(robot.limb(n))]
    return np.setdiff1d(np.arange(len(robot.joint_names)), off)


def _equilibrium(robot: RobotModel, plan: MotionPlan, k: int, feet: list[int]) -> tuple[Array, Array]:
    """(6 + n_J,) generalised gravity and (6 + n_J, 3 feet) Jᵀ of the contact points; base first, then the joints."""
    import pinocchio

    model, data = robot.pin, robot.pin_data
    q = robot.configuration(plan.base_poses[k : k + 1], plan.joint_positions[:, k][None])[0]
    order = [*range(6), *(model.joints[model.getJointId(name)].idx_v for name in robot.joint_names)]
    gravity = np.array(pinocchio.computeGeneralizedGravity(model, data, q))[order]
    pinocchio.computeJointJacobians(model, data, q)
    pinocchio.updateFramePlacements(model, data)
    pushes = []
    for i in feet:
        foot = robot.limbs[i].foot
        frame = model.getFrameId(foot.link, pinocchio.FrameType.BODY)
        J = pinocchio.getFrameJacobian(model, data, frame, pinocchio.LOCAL_WORLD_ALIGNED)
        arm = plan.feet[k, i] - [0.0, 0.0, foot.radius] - data.oMf[frame].translation
        pushes.append((J[:3] + np.cross(J[3:].T, arm).T).T[order])
    return gravity, np.hstack(pushes)


def _least(gravity: Array, pushes: Array, limits: Array, driven: NDArray[np.intp], friction: float) -> float:
    """Smallest t with |g − Jᵀ f| ≤ t · limit for some f in the pyramid that balances the base."""
    from scipy.optimize import linprog

    count = pushes.shape[1]
    torque, moved = gravity[6:][driven], pushes[6:][driven]
    ratio = np.concatenate([limits[driven], limits[driven]])[:, None]
    sides = np.kron(np.eye(count // 3), [[1, 0, -friction], [-1, 0, -friction], [0, 1, -friction], [0, -1, -friction]])
    found = linprog(
        np.append(np.zeros(count), 1.0),
        A_ub=np.block([[np.vstack([-moved, moved]), -ratio], [sides, np.zeros((len(sides), 1))]]),
        b_ub=np.concatenate([-torque, torque, np.zeros(len(sides))]),
        A_eq=np.hstack([pushes[:6], np.zeros((6, 1))]),
        b_eq=gravity[:6],
        bounds=[(None, None), (None, None), (0.0, None)] * (count // 3) + [(0.0, None)],
        method="highs",
    )
    return float(found.x[-1]) if found.status == 0 else float("inf")
