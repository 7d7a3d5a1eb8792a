"""`MujocoSimulator`: settle, then execute a timeline with compliant joint servos on compliant contacts."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitforge.errors import InputError, Problem, SimulationError
from gaitforge.motion.feedforward import planned_efforts
from gaitforge.motion.timeline import Timeline, TimelineSamples
from gaitforge.robot.model import RobotModel
from gaitforge.task.scene import Scene
from gaitforge.verify.assemble import assemble_trace
from gaitforge.verify.execution import planned_rows, planned_speeds, spawn_pose, tell
from gaitforge.verify.feedback import AimFeedback
from gaitforge.verify.mujoco.quiet import complaint, quiet
from gaitforge.verify.mujoco.recorder import Recorder
from gaitforge.verify.mujoco.settings import Physics
from gaitforge.verify.mujoco.world import World, build_world
from gaitforge.verify.sight import SightLines
from gaitforge.verify.simulator import Progress
from gaitforge.verify.trace import Trace
from gaitforge.verify.welds import Welder, welds_of

Array = NDArray[np.float64]


@dataclass(frozen=True)
class MujocoSimulator:
    """Rigid bodies with compliant contacts, and joint servos of finite stiffness within the modules' limits.

    The servo of a joint asks for the speed servo_rate (q* − q) + q̇*, at most the module's velocity, and
    gives the planned effort τ* and kv times what is missing of that speed, at most the module's effort: a
    position servo with kp = effort / full_effort_error and kv = kp / servo_rate.  The law is PyBullet's, where
    servo_rate is position_gain · rate_hz and kv as large as it needs to be.  Without the feed-forward of q̇* the
    joints lag by 1 / servo_rate in both; without that of τ* they sag by τ* / kp, which PyBullet's do not.
    """

    rate_hz: float = 500.0
    """[Hz] steps per second"""
    iterations: int = 100
    """[-] of the contact solver per step, at most"""
    full_effort_error: float = 0.01
    """[rad] error of a joint at which its servo gives the module's whole effort"""
    servo_rate: float = 72.0
    """[1/s] share of a joint's error that its servo makes good in a second; PyBullet's 0.3 at 240 Hz"""
    velocity_feedforward: float = 1.0
    """[-] share of the planned joint speed that is commanded ahead"""
    effort_feedforward: float = 1.0
    """[-] share of the planned joint efforts (`planned_efforts`) that is commanded beside position and speed"""
    aim_feedback_hz: float = 0.0
    """[Hz] how often tool limbs are aimed again from the measured pose of the body; 0: from the planned one, once"""
    friction: float = 1.0
    """[-] coefficient of every pair: a true cone"""
    torsional_friction: float = 0.01
    """[m] torque about the normal of a contact with a movable object, per newton of normal force; 0 = none"""
    contact_time: float = 0.004
    """[s] in which the penetration of a contact decays"""
    contact_depth: float = 0.0003
    """[m] penetration over which a contact grows to its full stiffness"""
    impedance_ratio: float = 100.0
    """[-] stiffness of friction over that of the normal direction: the larger, the less stance feet creep"""
    limp_friction: float = 0.2
    """[N m] dry friction of a joint whose motor is off: that of the series-elastic module's public URDF"""
    settle_s: float = 0.5
    """[s] standing still before the timeline begins"""
    name: str = "mujoco"

    def __post_init__(self) -> None:
        positive = (
            "rate_hz",
            "iterations",
            "full_effort_error",
            "servo_rate",
            "contact_time",
            "contact_depth",
            "impedance_ratio",
        )
        other = (
            "velocity_feedforward",
            "effort_feedforward",
            "friction",
            "torsional_friction",
            "limp_friction",
            "settle_s",
            "aim_feedback_hz",
        )
        values = {key: getattr(self, key) for key in (*positive, *other)}
        bad = [Problem("verify", k, repr(values[k]), "a number above 0") for k in positive if not values[k] > 0]
        bad += [Problem("verify", k, repr(values[k]), "a number not below 0") for k in other if not values[k] >= 0]
        if not bad and self.contact_time * self.rate_hz < 2.0:
            expected = f"at least two steps, {2.0 / self.rate_hz:g}"
            bad.append(Problem("verify", "contact_time", repr(self.contact_time), expected))
        if bad:
            raise InputError(bad)

    def run(self, robot: RobotModel, timeline: Timeline, scene: Scene, progress: Progress | None = None) -> Trace:
        """Execute the timeline; SimulationError when MuJoCo refuses the robot or its numbers run away."""
        plan = planned_rows(timeline, self.rate_hz)
        with quiet():
            welds = welds_of(timeline)
            world = build_world(robot, scene, self.physics(), welds)
            ahead = np.zeros_like(plan.joint_positions)
            if self.effort_feedforward:
                ahead = self.effort_feedforward * planned_efforts(robot, timeline, plan, self.rate_hz)
            self._settle(world, robot, plan, ahead[0])
            recorder, sight = Recorder(world, len(plan.times)), SightLines(world, robot, timeline, scene, plan.times)
            feedback = AimFeedback(world, robot, timeline, plan, self.aim_feedback_hz)
            self._walk(world, robot, plan, ahead, recorder, sight, feedback, Welder(world, welds), progress)
        recording = replace(recorder.recording(plan.times, sight.free), aim_feedback_hz=self.aim_feedback_hz)
        return assemble_trace(recording, plan, robot, timeline, scene)

    def physics(self) -> Physics:
        """What a model is built with."""
        return Physics(
            timestep=1.0 / self.rate_hz,
            iterations=int(self.iterations),
            full_effort_error=self.full_effort_error,
            servo_rate=self.servo_rate,
            friction=self.friction,
            torsional_friction=self.torsional_friction,
            contact_time=self.contact_time,
            contact_depth=self.contact_depth,
            impedance_ratio=self.impedance_ratio,
        )

    def _settle(self, world: World, robot: RobotModel, plan: TimelineSamples, ahead: Array) -> None:
        """Spawn with the feet on the ground, and stand."""
        world.place_robot(spawn_pose(robot, plan), plan.joint_positions[0])
        still = np.zeros(len(robot.joint_names))
        for _ in range(round(self.settle_s * self.rate_hz)):
            self._command(world, robot, plan.joint_positions[0], still, ahead, plan.efforts[0])
            world.mj.mj_step(world.model, world.data)

    def _walk(
        self,
        world: World,
        robot: RobotModel,
        plan: TimelineSamples,
        ahead: Array,
        recorder: Recorder,
        sight: SightLines,
        feedback: AimFeedback,
        welder: Welder,
        progress: Progress | None,
    ) -> None:
        """The loop; row k is the state at times[k], the step after it is commanded by row k of the plan."""
        mj, model, data, rows = world.mj, world.model, world.data, len(plan.times)
        speeds = self.velocity_feedforward * planned_speeds(plan, self.rate_hz)
        recorder.state(0)
        for row in range(rows):
            mj.mj_step1(model, data)
            sight.look(row)
            welder.at(plan.times[row])
            self._command(world, robot, feedback.positions(row), speeds[row], ahead[row], plan.efforts[row])
            mj.mj_step2(model, data)
            recorder.step(row)
            recorder.state(row + 1)
            if data.warning.number.any():
                raise SimulationError(f"{robot.name}: MuJoCo, at {plan.times[row]:.3f} s: {complaint(mj, data)}")
            tell(progress, row + 1, rows)

    def _command(
        self, world: World, robot: RobotModel, positions: Array, speeds: Array, ahead: Array, efforts: Array
    ) -> None:
        """A servo takes a position; the one that asks for the wanted speed and gives the effort ahead is put there."""
        q = world.data.qpos[world.positions]
        wanted = np.clip(self.servo_rate * (positions - q) + speeds, -robot.velocity, robot.velocity)
        world.data.ctrl[:] = q + wanted / self.servo_rate + self.full_effort_error * ahead / robot.effort
        off = efforts == 0.0  # a motor that is off resists every motion with its friction
        world.data.ctrl[off], most = q[off], np.where(off, self.limp_friction, efforts)
        world.model.actuator_forcerange[:, 0], world.model.actuator_forcerange[:, 1] = -most, most
