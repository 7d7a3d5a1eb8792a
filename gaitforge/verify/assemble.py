"""From a simulator's `Recording` to the `Trace`: everything that is derived, and the same for all simulators."""

from __future__ import annotations

import numpy as np

from gaitforge.motion.timeline import Timeline, TimelineSamples
from gaitforge.robot.model import RobotModel
from gaitforge.robot.run_kinematics import run_kinematics
from gaitforge.task.scene import Scene
from gaitforge.verify.feet import foot_contacts, foot_of_contacts, last_contact_points
from gaitforge.verify.grasps import grasp_contacts, laden_com
from gaitforge.verify.limp import expected_of_limp, limp_feet
from gaitforge.verify.pointing import pointing
from gaitforge.verify.recording import Recording
from gaitforge.verify.support import static_margin
from gaitforge.verify.trace import Trace
from gaitforge.verify.unplanned import force_in_swing, unplanned_contacts


def assemble_trace(
    recording: Recording, plan: TimelineSamples, robot: RobotModel, timeline: Timeline, scene: Scene
) -> Trace:
    """The trace of a run; `plan` is the planned motion at the recording's times.

    Slip: the contact point of a foot moves with v_j + ω × (0, 0, −r), the material velocity at the
    lowest point of its sphere, which is zero while the sphere rolls.  It is taken from the velocity
    with which the state moves on, so that its sum is the path that the simulator really went.
    """
    kinematics = run_kinematics(
        robot,
        recording.base_poses,
        recording.step_base_twists,
        recording.joint_positions,
        recording.step_joint_velocities,
    )
    table, links = recording.contacts, recording.links
    foot = foot_of_contacts(robot, table, kinematics.feet, links, table.link)
    other_foot = foot_of_contacts(robot, table, kinematics.feet, links, table.other)
    felt = foot_contacts(table, foot, len(recording.times), len(robot.limbs))
    com = laden_com(robot, timeline, plan, kinematics.com, recording.objects)
    radii = np.array([limb.foot.radius for limb in robot.limbs])
    points = last_contact_points(kinematics.feet, radii, felt.contact)
    slip = np.where(felt.contact, np.linalg.norm(kinematics.contact_velocity[:, :, :2], axis=2), 0.0)
    swing_force = force_in_swing(timeline, plan, felt.normal_force)
    return Trace(
        times=recording.times,
        plan=plan,
        base_poses=recording.base_poses,
        joint_positions=recording.joint_positions,
        joint_velocities=recording.joint_velocities,
        joint_torques=recording.joint_torques,
        normal_force=felt.normal_force,
        friction_force=felt.friction_force,
        contact_points=points,
        slip_speed=slip,
        feet=kinematics.feet,
        com=com,
        margin=static_margin(com[:, :2], points[:, :, :2], felt.contact & ~limp_feet(timeline, plan.segment)),
        pointing=pointing(timeline, recording.times, kinematics.tools),
        sight=recording.sight,
        unplanned=expected_of_limp(
            unplanned_contacts(
                robot, recording, scene, foot, other_foot, swing_force, grasp_contacts(robot, timeline, plan, scene)
            ),
            timeline,
        ),
        images=recording.images,
        camera_fov_deg=recording.camera_fov_deg,
        aim_feedback_hz=recording.aim_feedback_hz,
        objects=recording.objects,
        overlapping=recording.overlapping,
    )
