"""`/robot_description` and its see-through twin: what the viewer draws."""

from __future__ import annotations

from gaitforge.record.channels.channel import Channel, json_channel, text
from gaitforge.record.description import ghost, self_contained
from gaitforge.record.run import Run


def description_channels(run: Run) -> list[Channel]:
    """The URDF under the only schema name from which viewers draw it."""
    urdf = self_contained(run.robot.urdf)
    properties = {"data": text("URDF")}
    topics = {"/robot_description": urdf, "/plan/robot_description": ghost(urdf)}
    return [json_channel(t, "std_msgs/String", properties, [(run.stamp(0.0), {"data": x})]) for t, x in topics.items()]
