"""`/footfall/matrix` and `/footfall/cursor`: C as in the paper's figure 2, and where the run is in it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitforge.record.archive import segment_names
from gaitforge.record.channels.channel import Channel, Messages, protobuf_channel, set_stamp
from gaitforge.record.columns import Columns, columns_of
from gaitforge.record.png import png_bytes
from gaitforge.record.run import Run

SWING, STANCE, LINE, PAPER = (205, 45, 40), (255, 255, 255), (150, 150, 150), (244, 246, 248)
SEAM = (40, 40, 40)
FRAME = "footfall"


@dataclass(frozen=True)
class Grid:
    """Sizes of the picture [px]."""

    cell: int = 16
    """of a box, lines included"""
    left: int = 44
    """room for limb names"""
    top: int = 20
    """room for segment names"""


def matrix_channels(run: Run, grid: Grid | None = None) -> list[Channel]:
    """The picture once, and per column the cursor, with all the lettering, over it."""
    from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage
    from foxglove_schemas_protobuf.ImageAnnotations_pb2 import ImageAnnotations

    grid, columns = grid or Grid(), columns_of(run.timeline)
    image = CompressedImage(frame_id=FRAME, format="png", data=png_bytes(matrix_pixels(columns, grid)))
    stamp = set_stamp(image.timestamp, run, 0.0)
    return [
        protobuf_channel("/footfall/matrix", CompressedImage, [(stamp, image)]),
        protobuf_channel("/footfall/cursor", ImageAnnotations, _cursors(run, columns, grid)),
    ]


def matrix_pixels(columns: Columns, grid: Grid) -> NDArray[np.uint8]:
    """(h, w, 3) a box per limb and column: red = swing, white = stance; dark lines between segments."""
    cell, limbs = grid.cell, columns.contact.shape[1]
    height, width = grid.top + limbs * cell + 1, grid.left + len(columns) * cell + 1
    pixels = np.full((height, width, 3), PAPER, dtype=np.uint8)
    boxes = np.where(columns.contact.T[..., None], STANCE, SWING).astype(np.uint8)
    body = pixels[grid.top : -1, grid.left : -1]
    body[:] = boxes.repeat(cell, axis=0).repeat(cell, axis=1)
    pixels[grid.top :: cell, grid.left :] = LINE
    pixels[grid.top :, grid.left :: cell] = LINE
    for k in range(len(columns)):
        if k == 0 or columns.segment[k] != columns.segment[k - 1]:
            x = grid.left + k * cell
            pixels[:, x : x + 2] = SEAM
    return pixels


def _cursors(run: Run, columns: Columns, grid: Grid) -> Messages:
    from foxglove_schemas_protobuf.ImageAnnotations_pb2 import ImageAnnotations

    messages: Messages = []
    for k, time in enumerate(columns.times[:-1]):
        annotations = ImageAnnotations()
        stamp = _add_cursor(annotations, run, float(time), k, columns.contact.shape[1], grid)
        for text, x, y, size in _letters(run, columns, grid):
            label = annotations.texts.add(text=text, font_size=size)
            set_stamp(label.timestamp, run, time)
            label.position.x, label.position.y = x, y
            _color(label.text_color, 0.1, 0.1, 0.1, 1.0)
            _color(label.background_color, 1.0, 1.0, 1.0, 0.0)
        messages.append((stamp, annotations.SerializeToString()))
    return messages


def _add_cursor(annotations: Any, run: Run, time: float, column: int, limbs: int, grid: Grid) -> int:
    from foxglove_schemas_protobuf.PointsAnnotation_pb2 import PointsAnnotation

    box = annotations.points.add(type=PointsAnnotation.LINE_LOOP, thickness=3.0)
    x, y = grid.left + column * grid.cell, grid.top
    for dx, dy in ((0, 0), (1, 0), (1, limbs), (0, limbs)):
        box.points.add(x=x + dx * grid.cell, y=y + dy * grid.cell)
    _color(box.outline_color, 0.05, 0.35, 0.95, 1.0)
    _color(box.fill_color, 0.05, 0.35, 0.95, 0.15)
    return set_stamp(box.timestamp, run, time)


def _letters(run: Run, columns: Columns, grid: Grid) -> list[tuple[str, float, float, float]]:
    """(text, x, y of its lower left corner, size), all in pixels."""
    size = 0.7 * grid.cell
    letters = [(name, 4.0, grid.top + (row + 0.8) * grid.cell, size) for row, name in enumerate(run.robot.limb_names)]
    starts = np.flatnonzero(np.diff(columns.segment, prepend=-1))
    for name, start in zip(segment_names(run.timeline), starts, strict=True):
        letters.append((name, grid.left + start * grid.cell + 4.0, 0.75 * grid.top, size))
    return letters


def _color(color: Any, r: float, g: float, b: float, a: float) -> None:
    color.r, color.g, color.b, color.a = r, g, b, a
