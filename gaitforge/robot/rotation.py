"""Roll, pitch, yaw, matrices and quaternions of many poses at once (R = Rz(yaw) Ry(pitch) Rx(roll))."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def matrices(rpy: ArrayLike) -> Array:
    """(…, 3) roll, pitch, yaw [rad] → (…, 3, 3) rotation matrices."""
    angles = np.asarray(rpy, dtype=float)
    (cr, cp, cy), (sr, sp, sy) = (np.moveaxis(f(angles), -1, 0) for f in (np.cos, np.sin))
    rows = [
        np.stack([cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr], axis=-1),
        np.stack([sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr], axis=-1),
        np.stack([-sp, cp * sr, cp * cr], axis=-1),
    ]
    return np.stack(rows, axis=-2)


def matrices_of_quaternions(xyzw: ArrayLike) -> Array:
    """(…, 4) unit quaternions x, y, z, w → (…, 3, 3)."""
    x, y, z, w = np.moveaxis(np.asarray(xyzw, dtype=float), -1, 0)
    rows = [
        np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], axis=-1),
        np.stack([2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)], axis=-1),
        np.stack([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], axis=-1),
    ]
    return np.stack(rows, axis=-2)


def rpy_of_matrices(R: ArrayLike) -> Array:
    """(…, 3, 3) → (…, 3) roll, pitch, yaw [rad]; at pitch ±90° roll and yaw are not unique."""
    m = np.asarray(R, dtype=float)
    pitch = np.arctan2(-m[..., 2, 0], np.hypot(m[..., 0, 0], m[..., 1, 0]))
    roll = np.arctan2(m[..., 2, 1], m[..., 2, 2])
    yaw = np.arctan2(m[..., 1, 0], m[..., 0, 0])
    return np.stack([roll, pitch, yaw], axis=-1)


def quaternions(rpy: ArrayLike) -> Array:
    """(…, 3) roll, pitch, yaw [rad] → (…, 4) x, y, z, w."""
    half = 0.5 * np.asarray(rpy, dtype=float)
    (cr, cp, cy), (sr, sp, sy) = (np.moveaxis(f(half), -1, 0) for f in (np.cos, np.sin))
    parts = [
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    ]
    return np.stack(parts, axis=-1)


def poses_of(positions: ArrayLike, R: ArrayLike) -> Array:
    """(n, 3) positions and (n, 3, 3) rotations → (n, 6) x, y, z, roll, pitch, yaw with a continuous yaw."""
    rpy = rpy_of_matrices(R)
    rpy[:, 2] = np.unwrap(rpy[:, 2])
    return np.concatenate([np.asarray(positions, dtype=float), rpy], axis=1)
