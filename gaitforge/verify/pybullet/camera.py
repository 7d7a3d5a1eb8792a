"""What a camera sees: off-screen pictures by PyBullet's TinyRenderer, as PNG."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitforge.robot.limbs import ToolMount
from gaitforge.verify.pybullet.world import World

Array = NDArray[np.float64]
NEAR_M, FAR_M = 0.02, 20.0


def view_matrix(R: Array, origin: Array) -> list[float]:
    """OpenGL's view matrix, column by column, of an optical frame (z ahead, x right, y down)."""
    R_gl = R @ np.diag([1.0, -1.0, -1.0])
    V = np.eye(4)
    V[:3, :3], V[:3, 3] = R_gl.T, -R_gl.T @ origin
    return [float(v) for v in V.T.reshape(-1)]


def focal_length(height: int, fov_deg: float) -> float:
    """fx = fy [pixel] of a pinhole camera with a vertical opening angle."""
    return 0.5 * height / float(np.tan(np.radians(fov_deg) / 2.0))


def camera_picture(world: World, tool: ToolMount, size: tuple[int, int], fov_deg: float) -> bytes:
    """PNG of what the camera sees now; size is width, height [pixel]."""
    R_link, origin = world.link_pose(tool.link)
    R, eye = R_link @ tool.T_link_tool[:3, :3], origin + R_link @ tool.T_link_tool[:3, 3]
    projection = world.p.computeProjectionMatrixFOV(fov_deg, size[0] / size[1], NEAR_M, FAR_M)
    return png(render_pixels(world.p, world.client, size, view_matrix(R, eye), projection, shadow=False))


def render_pixels(
    p: Any, client: int, size: tuple[int, int], view: Any, projection: Any, shadow: bool, **light: Any
) -> NDArray[np.uint8]:
    """(height, width, 3)"""
    seen = p.getCameraImage(
        size[0],
        size[1],
        view,
        projection,
        shadow=int(shadow),
        renderer=p.ER_TINY_RENDERER,
        flags=p.ER_NO_SEGMENTATION_MASK,
        physicsClientId=client,
        **light,
    )
    pixels = np.asarray(seen[2], dtype=np.uint8).reshape(size[1], size[0], 4)
    return pixels[:, :, :3]


def png(pixels: NDArray[np.uint8], size: tuple[int, int] | None = None) -> bytes:
    """Pixels (height, width, 3) as PNG, scaled to `size` (width, height) when given."""
    from PIL import Image

    image = Image.fromarray(np.ascontiguousarray(pixels))
    if size is not None:
        image = image.resize(size, Image.Resampling.LANCZOS)
    out = io.BytesIO()
    image.save(out, format="PNG")
    return out.getvalue()
