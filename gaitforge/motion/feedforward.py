"""The efforts that hold and move a planned motion: what a joint is told ahead, beside its position and its speed."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.foot_shares import foot_shares
from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.timeline import Timeline, TimelineSamples
from gaitforge.robot.gravity import GRAVITY
from gaitforge.robot.kinematics import evaluate_alike, joint_axes, limb_parameters
from gaitforge.robot.model import RobotModel
from gaitforge.robot.rotation import matrices

Array = NDArray[np.float64]
EVEN = 0.8
"""[-] what it costs to depart from the feet's shares of the plan, over what effort costs: at 0 feet push each other
as hard as spares the motors most, which takes more friction than there is; far above 1 they do not push at all"""
SINGULAR = 1e-9
"""Relative: feet on one line, or fewer, cannot take every moment"""


def planned_efforts(robot: RobotModel, timeline: Timeline, rows: TimelineSamples, rate_hz: float) -> Array:
    """(n, n_J) efforts [N m] at rows of a timeline, 1 / rate_hz apart: τ = rnea(q, q̇, q̈) − Σ J_iᵀ f_i.

    The forces f_i below the feet balance the wrench b [N, N m] of the base, Σ G_i f_i = b with G_i = [1; r_i×], and
    minimise Σ_joints (τ / limit)² + c Σ_i |f_i|² / w_i: motors are spared, and a foot bears little where its share
    w_i (`foot_shares`) is small.  c is `EVEN` times what a force costs in the mean, over the number of feet that
    share, 1 / Σ w_i².  With c → ∞ and nothing but
    weight to bear f_i = m g w_i.  Loads count, also what tips have lifted, in what the feet bear: the limbs that
    hold it squeeze besides.  At the ends of a segment, where speeds may
    jump, accelerations are one-sided.
    """
    efforts, shares = np.zeros_like(rows.joint_positions), foot_shares(timeline, rows)
    for index in np.unique(rows.segment):
        here = np.flatnonzero(rows.segment == index)
        plan, base, joints = timeline.entries[index].plan, rows.base_poses[here], rows.joint_positions[here]
        laden = robot.carrying(*plan.loads)
        wrench, torques = _dynamics(laden, base, joints, rate_hz)
        if not plan.loads:
            wrench += _borne(plan, base, {name: poses[here] for name, poses in rows.loads.items()})
        feet = _feet(laden, base, joints)
        forces = _forces(wrench, feet, torques / laden.effort, shares[here])
        for limbs in feet.alike:
            torques[:, limbs.rows] -= np.einsum("lnij,nli->nlj", limbs.jacobians, forces[:, limbs.members])
        efforts[here] = torques
    return efforts


class _Alike(NamedTuple):
    """L limbs with equally many joints."""

    members: list[int]
    rows: NDArray[np.intp]
    """(L, n_joints) of P"""
    jacobians: Array
    """(L, n, 3, n_joints) of the contact point, world axes [m]"""
    limits: Array
    """(L, n_joints) [N m]"""


class _Feet(NamedTuple):
    """Where and on what the feet stand."""

    levers: Array
    """(n, n_F, 3) of the contact points from the base's origin, world axes [m]"""
    alike: list[_Alike]


def _dynamics(robot: RobotModel, base: Array, joints: Array, rate_hz: float) -> tuple[Array, Array]:
    """(n, 6) wrench [N, N m] that the base needs, about its origin in world axes, and (n, n_J) joint torques [N m]."""
    import pinocchio

    model, data = robot.pin, robot.pin_data
    order = [model.joints[model.getJointId(name)].idx_v for name in robot.joint_names]
    q = robot.configuration(base, joints)
    v = robot.velocity_vector(base, _rate(base, rate_hz), _rate(joints, rate_hz))
    a = _rate(v, rate_hz)
    found = np.array([pinocchio.rnea(model, data, *row) for row in zip(q, v, a, strict=True)])
    R = matrices(base[:, 3:6])
    wrench = [np.einsum("nij,nj->ni", R, found[:, k : k + 3]) for k in (0, 3)]
    return np.concatenate(wrench, axis=1), found[:, order]


def _rate(values: Array, rate_hz: float) -> Array:
    """Of values rate_hz a second, exact for parabolas to the very ends, where speeds may jump to those of others."""
    if len(values) < 2:
        return np.zeros_like(values)
    edge: Literal[1, 2] = 2 if len(values) > 2 else 1
    return np.asarray(np.gradient(values, 1.0 / rate_hz, axis=0, edge_order=edge))


def _borne(plan: MotionPlan, base: Array, loads: dict[str, Array]) -> Array:
    """(n, 6) wrench about the base's origin, world axes, that bears what tips have lifted."""
    wrench, R = np.zeros((len(base), 6)), matrices(base[:, 3:6])
    for holding in plan.holdings:
        lever = np.einsum("nij,nj->ni", R, loads[holding.object][:, :3])
        weight = holding.mass * GRAVITY * holding.borne(base[:, 2] + lever[:, 2])
        wrench[:, 2:5] += weight[:, None] * np.column_stack([np.ones(len(base)), lever[:, 1], -lever[:, 0]])
    return wrench


def _feet(robot: RobotModel, base: Array, joints: Array) -> _Feet:
    R, levers, alike = matrices(base[:, 3:6]), np.zeros((len(base), len(robot.limbs), 3)), []
    for members, rows, poses in evaluate_alike(robot, joints):
        limbs = [robot.limbs[i] for i in members]
        own = np.array([joint_axes(limb_parameters(robot, limb), rows.shape[1]) for limb in limbs])
        axes = np.einsum("nij,lnkjm,lkm->lnki", R, poses.turns, own, optimize=True)
        below = np.array([[0.0, 0.0, limb.foot.radius] for limb in limbs])[:, None]
        contact = np.einsum("nij,lnj->lni", R, poses.foot) - below
        arms = contact[:, :, None] - np.einsum("nij,lnkj->lnki", R, poses.origins)
        levers[:, members] = contact.swapaxes(0, 1)
        alike.append(_Alike(members, rows, np.cross(axes, arms).swapaxes(2, 3), robot.effort[rows]))
    return _Feet(levers, alike)


def _forces(wrench: Array, feet: _Feet, ratios: Array, shares: Array) -> Array:
    """(n, n_F, 3) [N] below the feet that add up to a wrench (n, 6); ratios (n, n_J): efforts without them over limits.

    f_i = (H_i + c / w_i)⁻¹ (h_i + G_iᵀ λ) with H_i = J_i limit⁻² J_iᵀ and h_i = J_i limit⁻¹ ratio.
    """
    count = feet.levers.shape[1]
    H, h = np.zeros((len(wrench), count, 3, 3)), np.zeros((len(wrench), count, 3))
    for limbs in feet.alike:
        scaled = limbs.jacobians / limbs.limits[:, None, None]
        H[:, limbs.members] = np.einsum("lnij,lnkj->nlik", scaled, scaled)
        h[:, limbs.members] = np.einsum("lnij,nlj->nli", scaled, ratios[:, limbs.rows])
    cost = EVEN * np.trace(H, axis1=2, axis2=3).mean() / 3.0 * (shares**2).sum(axis=1)
    cost = np.where(cost > 0.0, cost, 1.0)  # no foot stands: there is nothing to share
    w = shares[:, :, None, None]
    give = w * np.linalg.inv(w * H + cost[:, None, None, None] * np.eye(3))
    G = np.zeros((len(wrench), count, 6, 3))
    x, y, z = np.moveaxis(feet.levers, -1, 0)
    G[:, :, :3] = np.eye(3)
    G[:, :, 3, 1], G[:, :, 3, 2], G[:, :, 4, 0], G[:, :, 4, 2], G[:, :, 5, 0], G[:, :, 5, 1] = -z, y, z, -x, -y, x
    given = G @ give
    inner = (given @ G.swapaxes(2, 3)).sum(axis=1)
    rest = wrench - np.einsum("nfij,nfj->ni", given, h)
    multipliers = np.einsum("nij,nj->ni", np.linalg.pinv(inner, SINGULAR, hermitian=True), rest)
    return np.asarray(np.einsum("nfij,nfj->nfi", give, h) + np.einsum("nfij,ni->nfj", given, multipliers))
