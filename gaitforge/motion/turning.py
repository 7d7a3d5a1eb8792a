r"""Derivatives of what a chain of turns moves, without differentiating its kinematics.

A base with Rz(yaw) Ry(pitch) Rx(roll) and a limb's joints are one chain of turns about axes a_0, a_1, … through
origins o_0, o_1, …, from proximal to distal.  A point P that the whole chain moves has

    ∂P/∂θ_i = a_i × (P − o_i)        ∂²P/∂θ_i∂θ_j = a_i × (a_j × (P − o_j))   for i ≤ j,

and so has any vector (with no origin) and, with masses for weights, a sum of points.  Everything here is
symbolic; the results are tens of operations an entry, where differentiating the kinematics takes hundreds.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from gaitforge.robot.kinematics import LimbState

RPY = (5, 4, 3)
"""Places of yaw, pitch and roll, in the order of the chain, in a base pose."""


def base_axes(rpy: Any) -> list[Any]:
    """Axes of yaw, pitch and roll in the base frame, each (3,)."""
    import casadi as ca

    cr, sr, cp, sp = ca.cos(rpy[0]), ca.sin(rpy[0]), ca.cos(rpy[1]), ca.sin(rpy[1])
    return [ca.vertcat(-sp, cp * sr, cp * cr), ca.vertcat(0, cr, -sr), ca.SX([1, 0, 0])]


def chain_axes(rpy: Any, state: LimbState, local: Sequence[Any]) -> list[Any]:
    """Axes of the whole chain in the base frame; `local`: each joint's axis in the frame of its body."""
    return [*base_axes(rpy), *(turn @ axis for turn, axis in zip(state.turns, local, strict=True))]


def first(axes: Sequence[Any], arms: Sequence[Any]) -> list[Any]:
    """a_i × d_i with arms d_i = P − o_i."""
    import casadi as ca

    return [ca.cross(a, d) for a, d in zip(axes, arms, strict=True)]


def second(axes: Sequence[Any], firsts: Sequence[Any], multiplier: Any) -> list[list[Any]]:
    """λ · ∂²P/∂θ_i∂θ_j = (λ × a_i) · (a_j × d_j) for i ≤ j, as rows of a triangle."""
    import casadi as ca

    pulls = [ca.cross(multiplier, a) for a in axes]
    return [[ca.dot(pulls[i], firsts[j]) for j in range(i, len(axes))] for i in range(len(axes))]


def place(target: Any, at: Sequence[int], triangle: Sequence[Sequence[Any]]) -> None:
    """Add a triangle over the variables `at` to the upper triangle of a symbolic matrix."""
    for i, row in enumerate(triangle):
        for j, entry in enumerate(row, start=i):
            a, b = sorted((at[i], at[j]))
            target[a, b] += entry
