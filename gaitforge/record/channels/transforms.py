"""`/tf`, `/plan/tf`, `/sim/base`, `/plan/path`: where every link is and was meant to be."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from gaitforge.record.channels.channel import Channel, Messages, protobuf_channel, set_stamp
from gaitforge.record.run import Run
from gaitforge.record.tree import Array, base_to_pose, matrix_to_quaternion

WORLD = "world"
PLAN_PREFIX = "plan/"


def transform_channels(run: Run) -> list[Channel]:
    """All frames in ONE message a stamp: viewers lose single transforms when they seek."""
    from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms

    trace, rows = run.trace, run.rows
    camera = run.camera
    seen = {run.camera_frame: (camera.link, camera.T_link_tool)} if camera else {}
    simulated = _frames(run, "", trace.base_poses[rows], trace.joint_positions[rows], seen)
    planned = _frames(run, PLAN_PREFIX, trace.plan.base_poses[rows], trace.plan.joint_positions[rows], {})
    return [
        protobuf_channel("/tf", FrameTransforms, simulated),
        protobuf_channel("/plan/tf", FrameTransforms, planned),
    ]


def base_channels(run: Run) -> list[Channel]:
    """The body: where it is, and the way it is planned to go."""
    from foxglove_schemas_protobuf.PoseInFrame_pb2 import PoseInFrame
    from foxglove_schemas_protobuf.PosesInFrame_pb2 import PosesInFrame

    message, messages = PoseInFrame(frame_id=WORLD), []
    for row, pose in zip(run.rows, base_to_pose(run.trace.base_poses[run.rows]), strict=True):
        stamp = set_stamp(message.timestamp, run, run.trace.times[row])
        set_pose(message.pose, pose)
        messages.append((stamp, message.SerializeToString()))
    path = PosesInFrame(frame_id=WORLD)
    stamp = set_stamp(path.timestamp, run, 0.0)
    for pose in base_to_pose(run.trace.plan.base_poses[run.scene_rows]):
        set_pose(path.poses.add(), pose)
    return [
        protobuf_channel("/sim/base", PoseInFrame, messages),
        protobuf_channel("/plan/path", PosesInFrame, [(stamp, path)]),
    ]


def set_pose(message: Any, pose: Array) -> None:
    """Fill a foxglove.Pose from x, y, z and quaternion x, y, z, w."""
    message.position.x, message.position.y, message.position.z = pose[:3].tolist()
    q = message.orientation
    q.x, q.y, q.z, q.w = pose[3:].tolist()


def _frames(run: Run, prefix: str, base: Array, joints: Array, fixed: Mapping[str, tuple[str, Array]]) -> Messages:
    """The tree at every logged row; `fixed`: frames that stay where they are in a link, name → link, pose (4, 4)."""
    from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms

    tree = run.tree
    still = [np.concatenate([T[:3, 3], matrix_to_quaternion(T[:3, :3])]) for _, T in fixed.values()]
    at_rest = np.tile(np.reshape(still, (1, len(still), 7)), (len(base), 1, 1))
    poses = np.concatenate(
        [base_to_pose(base)[:, None], tree.relative(run.robot.joint_names, joints), at_rest], axis=1
    ).tolist()  # (n, L, 7) as Python floats: protobuf takes them twice as fast
    message = FrameTransforms()
    parents = [WORLD] + [prefix + edge.parent for edge in tree.edges] + [link for link, _ in fixed.values()]
    for parent, child in zip(parents, [*tree.links, *fixed], strict=True):
        message.transforms.add(parent_frame_id=parent, child_frame_id=prefix + child)
    slots = [(t.timestamp, t.translation, t.rotation) for t in message.transforms]
    messages: Messages = []
    for row, stamp_poses in zip(run.rows.tolist(), poses, strict=True):
        stamp = run.stamp(run.trace.times[row])
        seconds, nanos = divmod(stamp, 1_000_000_000)
        for (timestamp, p, q), pose in zip(slots, stamp_poses, strict=True):
            timestamp.seconds, timestamp.nanos = seconds, nanos
            p.x, p.y, p.z, q.x, q.y, q.z, q.w = pose
        messages.append((stamp, message.SerializeToString()))
    return messages
