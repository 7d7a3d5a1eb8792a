"""Pictures of a simulated run: the robot is put where the trace says and drawn off-screen, nothing is stepped.

PyBullet's TinyRenderer draws them, whichever simulator the trace is from: it needs no display.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from gaitforge.robot.model import RobotModel
from gaitforge.task.scene import Scene
from gaitforge.verify.pybullet.camera import png, render_pixels
from gaitforge.verify.pybullet.client import direct_client
from gaitforge.verify.pybullet.world import World, build_world

Array = NDArray[np.float64]
Color = tuple[float, float, float, float]
TILES: tuple[Color, Color] = ((0.90, 0.91, 0.92, 1.0), (0.83, 0.85, 0.87, 1.0))
TILE_M = 0.5
FLOOR_M = 60.0
LIGHT_M = 10.0
"""Distance of the light [m]: nearer, the edge of its shadow map is seen; farther, shadows go coarse."""
FINER = 2
"""Drawn this many times larger and then made smaller, which softens the edges."""


class Poses(Protocol):
    """What is drawn, row by row: a `Trace`, or what a log recorded (`gaitforge.record.poses`)."""

    @property
    def times(self) -> Array:
        """(n,) [s]"""

    @property
    def base_poses(self) -> Array:
        """(n, 6) of base_link in the world [m, rad]"""

    @property
    def joint_positions(self) -> Array:
        """(n, n_J) [rad]"""

    @property
    def feet(self) -> Array:
        """(n, n_F, 3) [m]"""

    @property
    def objects(self) -> dict[str, Array]:
        """Name of what can be moved → (n, 7) position [m] and quaternion x, y, z, w in the world"""


@dataclass(frozen=True)
class View:
    """A camera that follows the robot."""

    yaw_deg: float = 35.0
    """[deg] where it stands: 0 behind the robot, 90 to its right"""
    pitch_deg: float = -24.0
    """[deg] down is negative"""
    distance: float | None = None
    """[m] from the point looked at; None: 1.8 times the span of the feet, or what a tall robot needs"""
    ahead: float = 0.0
    """[m] the point looked at lies this far in front of the robot"""


def view_of(scene: Scene) -> View:
    """From behind, or from ahead where there is something to carry: the trunk would hide it."""
    return View(yaw_deg=145.0) if any(item.movable for item in scene.objects) else View()


def render(
    robot: RobotModel,
    trace: Poses,
    scene: Scene,
    times: Sequence[float],
    size: tuple[int, int] = (960, 540),
    *,
    yaw_deg: float = 35.0,
    pitch_deg: float = -24.0,
    distance: float | None = None,
    ahead: float = 0.0,
) -> list[bytes]:
    """PNG of the robot at each of `times` [s], seen by a camera that follows it; see `View`.

    size: width, height [pixel].  Shapes have the colours of the URDF.
    """
    view = View(yaw_deg, pitch_deg, distance, ahead)
    drawn = (size[0] * FINER, size[1] * FINER)
    return [png(pixels, size) for pixels in frames(robot, trace, scene, times, drawn, view)]


def frames(
    robot: RobotModel, trace: Poses, scene: Scene, times: Sequence[float], size: tuple[int, int], view: View
) -> Iterator[NDArray[np.uint8]]:
    """(height, width, 3) pixels at each of `times` [s], one after the other; size is width, height [pixel]."""
    rows = np.clip(np.searchsorted(trace.times, np.asarray(times, dtype=float)), 0, len(trace.times) - 1)
    if not len(rows):
        return
    tall = 1.7 * float(trace.base_poses[0, 2])
    reach = view.distance or 1.8 * max(float(np.ptp(trace.feet[rows[0], :, :2], axis=0).max()), tall)
    with _studio(robot, scene, trace.base_poses[rows, :2], 1.6 * reach + view.ahead) as world:
        for row in rows:
            yield _drawn(world, trace, int(row), size, view, reach)


@contextmanager
def _studio(robot: RobotModel, scene: Scene, path: Array, margin: float) -> Iterator[World]:
    """Robot and scene on a chequered floor under the path."""
    with direct_client(f"pictures of {robot.name}") as (p, client):
        world = build_world(p, client, robot, scene, friction=1.0)
        p.resetBasePositionAndOrientation(world.ground, [0, 0, -FLOOR_M], [0, 0, 0, 1], physicsClientId=client)
        _lay_tiles(p, client, path, margin)
        yield world


def _drawn(world: World, trace: Poses, row: int, size: tuple[int, int], view: View, reach: float) -> NDArray[np.uint8]:
    p, pose = world.p, trace.base_poses[row]
    world.place_robot(pose, trace.joint_positions[row])
    for name, body in world.movable.items():
        place = trace.objects[name][row]
        p.resetBasePositionAndOrientation(body, place[:3], place[3:], physicsClientId=world.client)
    target = [pose[0] + view.ahead * np.cos(pose[5]), pose[1] + view.ahead * np.sin(pose[5]), 0.7 * pose[2]]
    heading = float(np.degrees(pose[5])) - 90.0 + view.yaw_deg  # PyBullet's yaw 0 looks along +y
    look = p.computeViewMatrixFromYawPitchRoll(target, reach, heading, view.pitch_deg, 0.0, 2)
    lens = p.computeProjectionMatrixFOV(40.0, size[0] / size[1], 0.05, 4.0 * reach + 5.0)
    return render_pixels(
        p,
        world.client,
        size,
        look,
        lens,
        shadow=True,
        lightDistance=LIGHT_M,
        lightDirection=[target[0] + 1.0, target[1] - 1.5, 4.0],
        lightAmbientCoeff=0.62,
        lightDiffuseCoeff=0.45,
        lightSpecularCoeff=0.05,
    )


def _lay_tiles(p: Any, client: int, path: Array, margin: float) -> None:
    """A chequered floor under the path in a wide plain one, just below the ground; PyBullet's own is bright blue."""
    wide = [FLOOR_M, FLOOR_M, 0.002]
    plain = p.createVisualShape(p.GEOM_BOX, halfExtents=wide, rgbaColor=TILES[0], physicsClientId=client)
    p.createMultiBody(0, -1, plain, [0.0, 0.0, -0.012], physicsClientId=client)
    half = [0.5 * TILE_M, 0.5 * TILE_M, 0.002]
    shapes = [
        p.createVisualShape(p.GEOM_BOX, halfExtents=half, rgbaColor=color, physicsClientId=client) for color in TILES
    ]
    first, last = (np.floor((edge) / TILE_M).astype(int) for edge in (path.min(0) - margin, path.max(0) + margin))
    for i in range(first[0], last[0] + 1):
        for j in range(first[1], last[1] + 1):
            at = [(i + 0.5) * TILE_M, (j + 0.5) * TILE_M, -0.002]
            p.createMultiBody(0, -1, shapes[(i + j) % 2], at, physicsClientId=client)
