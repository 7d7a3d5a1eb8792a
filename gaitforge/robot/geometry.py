"""Rigid transforms, primitive shapes and rigid-body inertias."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
ShapeKind = Literal["box", "cylinder", "sphere", "mesh"]


def rotation(rpy: Sequence[float]) -> Array:
    """(3, 3) R = Rz(yaw) Ry(pitch) Rx(roll) for roll, pitch, yaw [rad]."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def pose(xyz: Sequence[float] = (0.0, 0.0, 0.0), rpy: Sequence[float] = (0.0, 0.0, 0.0)) -> Array:
    """(4, 4) homogeneous transform from a position [m] and roll, pitch, yaw [rad]."""
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = rotation(rpy), xyz
    return T


def inverse(T: Array) -> Array:
    """(4, 4) inverse of a rigid transform."""
    out = np.eye(4)
    out[:3, :3], out[:3, 3] = T[:3, :3].T, -T[:3, :3].T @ T[:3, 3]
    return out


def turn(axis: Sequence[float], angle: ArrayLike) -> Array:
    """(…, 4, 4) rotation by angles (…) [rad] about the unit vector `axis` (Rodrigues' formula)."""
    x, y, z = axis
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    by = np.asarray(angle, dtype=float)[..., None, None]
    out = np.zeros((*by.shape[:-2], 4, 4))
    out[..., :3, :3] = np.eye(3) + np.sin(by) * K + (1.0 - np.cos(by)) * (K @ K)
    out[..., 3, 3] = 1.0
    return out


def clean(T: Array) -> Array:
    """The same matrix without the last bits of floating-point noise (2e-17 becomes 0)."""
    return np.asarray(np.round(T, 12) + 0.0)


@dataclass(frozen=True, eq=False)
class Shape:
    """A primitive or mesh, placed in the frame of its body."""

    kind: ShapeKind
    size: tuple[float, ...]
    """box: edge lengths x, y, z [m] · cylinder (along z): radius, length [m] · sphere: radius [m] · mesh: scale"""
    placement: Array = field(default_factory=lambda: np.eye(4))
    """(4, 4) in the body frame"""
    file: str = ""
    """Path of a mesh."""
    color: tuple[float, ...] | None = None
    """rgba, 0…1"""
    mass: float | None = None
    """[kg] of this shape alone; None: the body's mass is spread by volume"""
    collision: bool = True
    visual: bool = True

    def moved(self, T: Array) -> Shape:
        """The shape in the frame that `T` (4, 4) maps its frame to."""
        return replace(self, placement=T @ self.placement)

    @property
    def volume(self) -> float:
        """[m³]; 0 for a mesh."""
        if self.kind == "box":
            return float(np.prod(self.size))
        if self.kind == "cylinder":
            return float(np.pi * self.size[0] ** 2 * self.size[1])
        return float(4.0 / 3.0 * np.pi * self.size[0] ** 3) if self.kind == "sphere" else 0.0

    def unit_inertia(self) -> Array:
        """(3, 3) inertia about the centre per kg, homogeneous solid, in the shape's frame [m²]."""
        if self.kind == "box":
            xx, yy, zz = np.square(self.size) / 12.0
            return np.diag([yy + zz, xx + zz, xx + yy])
        if self.kind == "cylinder":
            r2, l2 = np.square(self.size)
            return np.diag([r2 / 4 + l2 / 12, r2 / 4 + l2 / 12, r2 / 2])
        return np.eye(3) * 0.4 * self.size[0] ** 2


@dataclass(frozen=True, eq=False)
class Inertia:
    """Mass, centre of mass and rotational inertia of a rigid body."""

    mass: float = 0.0
    """[kg]"""
    com: Array = field(default_factory=lambda: np.zeros(3))
    """(3,) centre of mass in the body frame [m]"""
    matrix: Array = field(default_factory=lambda: np.zeros((3, 3)))
    """(3, 3) about the centre of mass, axes of the body frame [kg m²]"""

    def moved(self, T: Array) -> Inertia:
        """The same body seen from the frame that `T` (4, 4) maps its frame to."""
        R = T[:3, :3]
        return Inertia(self.mass, R @ self.com + T[:3, 3], R @ self.matrix @ R.T)


def merged(parts: Iterable[Inertia]) -> Inertia:
    """One rigid body made of several, all in one frame (parallel-axis theorem)."""
    parts = [p for p in parts if p.mass > 0.0]
    mass = sum(p.mass for p in parts)
    if not parts:
        return Inertia()
    com = sum((p.mass * p.com for p in parts), np.zeros(3)) / mass
    matrix = np.zeros((3, 3))
    for part in parts:
        d = part.com - com
        matrix += part.matrix + part.mass * (d @ d * np.eye(3) - np.outer(d, d))
    return Inertia(float(mass), com, matrix)


def inertia_of_shapes(shapes: Sequence[Shape], mass: float | None) -> Inertia:
    """Homogeneous solids: each shape's own mass, or the body's `mass` [kg] spread by volume."""
    own = [s.mass for s in shapes]
    if mass is not None:
        total = sum(s.volume for s in shapes)
        own = [mass * s.volume / total if total else 0.0 for s in shapes]
    solids = [Inertia(m or 0.0, np.zeros(3), (m or 0.0) * s.unit_inertia()) for s, m in zip(shapes, own, strict=True)]
    return merged(i.moved(s.placement) for s, i in zip(shapes, solids, strict=True))


def inertia_defect(matrix: Array) -> str | None:
    """Why `matrix` (3, 3) cannot be a rigid body's inertia, or None: definite, and a + b ≥ c for its eigenvalues."""
    if not np.allclose(matrix, matrix.T):
        return "a matrix that is not symmetric"
    a, b, c = np.linalg.eigvalsh(matrix)
    if a <= 0.0:
        return f"an eigenvalue of {a:.3g} kg m² (not positive definite)"
    if a + b < c * (1.0 - 1e-6):
        return f"principal moments {a:.3g} + {b:.3g} < {c:.3g} kg m² (triangle inequality)"
    return None
