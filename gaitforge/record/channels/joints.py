"""`/sim/joint_states` and `/plan/joint_states`."""

from __future__ import annotations

import numpy as np

from gaitforge.motion.feedforward import planned_efforts
from gaitforge.record.channels.channel import Channel, Messages, protobuf_channel, set_stamp
from gaitforge.record.run import Run
from gaitforge.record.tree import Array


def joint_channels(run: Run) -> list[Channel]:
    """Position [rad], velocity [rad/s] and effort [N m] of every joint.

    The plan's efforts are what `planned_efforts` tells a servo ahead, 0 where a motor is off; what squeezes a load
    is not in them.
    """
    from foxglove_schemas_protobuf.JointStates_pb2 import JointStates

    trace, rows = run.trace, run.rows
    measured = (trace.joint_positions[rows], trace.joint_velocities[rows], trace.joint_torques[rows])
    rate_hz = 1.0 / float(trace.times[1] - trace.times[0]) if len(trace.times) > 1 else run.rate_hz
    efforts = np.where(trace.plan.efforts, planned_efforts(run.robot, run.timeline, trace.plan, rate_hz), 0.0)
    planned = (trace.plan.joint_positions[rows], trace.plan.joint_velocities[rows], efforts[rows])
    return [
        protobuf_channel("/sim/joint_states", JointStates, _states(run, *measured)),
        protobuf_channel("/plan/joint_states", JointStates, _states(run, *planned)),
    ]


def _states(run: Run, positions: Array, velocities: Array, efforts: Array) -> Messages:
    from foxglove_schemas_protobuf.JointStates_pb2 import JointStates

    message = JointStates()
    for name in run.robot.joint_names:
        message.joints.add(name=name)
    joints = list(message.joints)
    messages: Messages = []
    for k, row in enumerate(run.rows.tolist()):
        stamp = set_stamp(message.timestamp, run, run.trace.times[row])
        values = zip(positions[k].tolist(), velocities[k].tolist(), efforts[k].tolist(), strict=True)
        for joint, (position, velocity, effort) in zip(joints, values, strict=True):
            joint.position, joint.velocity, joint.effort = position, velocity, effort
        messages.append((stamp, message.SerializeToString()))
    return messages
