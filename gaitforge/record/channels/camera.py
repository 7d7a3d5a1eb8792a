"""`/camera/image`, `/camera/info`: what a camera limb saw, when the simulator was asked for pictures."""

from __future__ import annotations

import struct

import numpy as np

from gaitforge.record.channels.channel import Channel, protobuf_channel, set_stamp
from gaitforge.record.run import Run
from gaitforge.verify.pybullet.camera import focal_length


def camera_channels(run: Run) -> list[Channel]:
    """Pictures and the pinhole that took them, in the camera's optical frame; nothing when there are none."""
    from foxglove_schemas_protobuf.CameraCalibration_pb2 import CameraCalibration
    from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage

    if not run.trace.images:
        return []
    frame = run.camera_frame
    images, infos = [], []
    for time, png in run.trace.images:
        image = CompressedImage(frame_id=frame, format="png", data=png)
        images.append((set_stamp(image.timestamp, run, time), image))
        width, height = png_size(png)
        K, P = pinhole(focal_length(height, run.trace.camera_fov_deg), width, height)
        info = CameraCalibration(frame_id=frame, width=width, height=height, K=K, R=np.eye(3).ravel().tolist(), P=P)
        infos.append((set_stamp(info.timestamp, run, time), info))
    return [
        protobuf_channel("/camera/image", CompressedImage, images),
        protobuf_channel("/camera/info", CameraCalibration, infos),
    ]


def pinhole(focal: float, width: int, height: int) -> tuple[list[float], list[float]]:
    """K (3 × 3) and P (3 × 4), row by row, without distortion; pixels are counted from the middle of the first one."""
    K = np.array([[focal, 0.0, 0.5 * (width - 1)], [0.0, focal, 0.5 * (height - 1)], [0.0, 0.0, 1.0]])
    return K.ravel().tolist(), np.hstack([K, np.zeros((3, 1))]).ravel().tolist()


def png_size(png: bytes) -> tuple[int, int]:
    """Width and height [pixel]: the first two numbers of a PNG's header."""
    width, height = struct.unpack(">II", png[16:24])
    return int(width), int(height)
