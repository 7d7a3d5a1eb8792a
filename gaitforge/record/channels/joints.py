"""`/sim/joint_states` and `/plan/joint_states`."""

from __future__ import annotations

from gaitforge.record.channels.channel import Channel, Messages, protobuf_channel, set_stamp
from gaitforge.record.run import Run
from gaitforge.record.tree import Array


def joint_channels(run: Run) -> list[Channel]:
    """Position [rad], velocity [rad/s] and, simulated, effort [N m] of every joint."""
    from foxglove_schemas_protobuf.JointStates_pb2 import JointStates

    trace, rows = run.trace, run.rows
    measured = (trace.joint_positions[rows], trace.joint_velocities[rows], trace.joint_torques[rows])
    planned = (trace.plan.joint_positions[rows], trace.plan.joint_velocities[rows])
    return [
        protobuf_channel("/sim/joint_states", JointStates, _states(run, *measured)),
        protobuf_channel("/plan/joint_states", JointStates, _states(run, *planned)),
    ]


def _states(run: Run, positions: Array, velocities: Array, efforts: Array | None = None) -> Messages:
    from foxglove_schemas_protobuf.JointStates_pb2 import JointStates

    message = JointStates()
    for name in run.robot.joint_names:
        message.joints.add(name=name)
    joints = list(message.joints)
    messages: Messages = []
    for k, row in enumerate(run.rows.tolist()):
        stamp = set_stamp(message.timestamp, run, run.trace.times[row])
        for joint, position, velocity in zip(joints, positions[k].tolist(), velocities[k].tolist(), strict=True):
            joint.position, joint.velocity = position, velocity
        if efforts is not None:
            for joint, effort in zip(joints, efforts[k].tolist(), strict=True):
                joint.effort = effort
        messages.append((stamp, message.SerializeToString()))
    return messages
