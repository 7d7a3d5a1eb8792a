"""`/camera/image`: what a camera limb saw, when the simulator was asked for pictures."""

from __future__ import annotations

from gaitforge.record.channels.channel import Channel, protobuf_channel, set_stamp
from gaitforge.record.run import Run


def camera_channels(run: Run) -> list[Channel]:
    """Pictures in the frame of the link that carries the camera; nothing when there are none."""
    from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage

    if not run.trace.images:
        return []
    camera = next((tool for tool in run.robot.tools if tool.kind == "camera"), None)
    messages = []
    for time, png in run.trace.images:
        image = CompressedImage(frame_id=camera.link if camera else run.robot.base_link, format="png", data=png)
        messages.append((set_stamp(image.timestamp, run, time), image))
    return [protobuf_channel("/camera/image", CompressedImage, messages)]
