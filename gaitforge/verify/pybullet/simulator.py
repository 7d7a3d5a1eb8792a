"""`PyBulletSimulator`: settle, then execute a timeline with joint servos, 240 times a second."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gaitforge.errors import InputError, Problem
from gaitforge.motion.timeline import Timeline, TimelineSamples
from gaitforge.robot.model import RobotModel
from gaitforge.task.scene import Scene
from gaitforge.verify.assemble import assemble_trace
from gaitforge.verify.execution import planned_rows, planned_speeds, spawn_pose, tell
from gaitforge.verify.feedback import AimFeedback
from gaitforge.verify.pybullet.camera import camera_picture
from gaitforge.verify.pybullet.client import direct_client
from gaitforge.verify.pybullet.recorder import Recorder
from gaitforge.verify.pybullet.world import World, build_world
from gaitforge.verify.sight import SightLines
from gaitforge.verify.simulator import Progress
from gaitforge.verify.trace import Trace
from gaitforge.verify.welds import Welder, welds_of

Array = NDArray[np.float64]
CONE_ITERATIONS, CONE_RESIDUAL = 1000, 5e-4
"""Of a step in a grasp, in which a chain is closed: slips of 2 mm, with 500 iterations of 4.4"""


@dataclass(frozen=True)
class PyBulletSimulator:
    """Rigid-body simulation with joint servos that keep the modules' effort and velocity limits.

    The servo asks each step for the joint speed position_gain · (q* − q) · rate_hz + q̇*, at most the
    module's velocity, with at most the module's effort.  The second term is the feed-forward of the
    planned speed that a real servo has; without it the joints lag by 1 / (position_gain · rate_hz).
    Same plan, same settings: the same numbers to the last bit.
    """

    rate_hz: float = 240.0
    """[Hz] steps per second; position_gain is a share per step, so keep the two together"""
    solver_iterations: int = 500
    """[-] of the contact solver per step, at most"""
    solver_residual: float = 1e-3
    """[m²/s² or rad²/s²] at which the contact solver ends before that: the largest change of a row's speed in one
    iteration, squared; feet of a many-legged stance creep where it is larger"""
    position_gain: float = 0.3
    """[-] share of a joint's error that the servo makes good in one step"""
    velocity_feedforward: float = 1.0
    """[-] share of the planned joint speed that is commanded ahead"""
    aim_feedback_hz: float = 0.0
    """[Hz] how often tool limbs are aimed again from the measured pose of the body; 0: from the planned one, once"""
    friction: float = 1.0
    """[-] coefficient of a pair, robot and ground or robot and object"""
    friction_cone: bool = False
    """True: Coulomb's cone, which wants a smaller solver_residual where many stiff limbs stand. False: the
    four-sided pyramid inside the cone, which converges five times sooner and never grips more than the cone"""
    limp_friction: float = 0.2
    """[N m] dry friction of a joint whose motor is off: that of the series-elastic module's public URDF"""
    settle_s: float = 0.5
    """[s] standing still before the timeline begins"""
    camera_hz: float = 0.0
    """[Hz] pictures of the camera; 0 = none"""
    camera_size: tuple[int, int] = (320, 240)
    """[pixel] width, height"""
    camera_fov_deg: float = 60.0
    """[deg] vertical opening angle"""
    name: str = "pybullet"

    def __post_init__(self) -> None:
        object.__setattr__(self, "camera_size", tuple(int(v) for v in self.camera_size))
        positive = {k: getattr(self, k) for k in ("rate_hz", "solver_iterations", "position_gain", "camera_fov_deg")}
        bad = [Problem("verify", k, repr(v), "a number above 0") for k, v in positive.items() if not v > 0]
        other = {
            k: getattr(self, k)
            for k in (
                "solver_residual",
                "velocity_feedforward",
                "friction",
                "limp_friction",
                "settle_s",
                "camera_hz",
                "aim_feedback_hz",
            )
        }
        bad += [Problem("verify", k, repr(v), "a number not below 0") for k, v in other.items() if not v >= 0]
        if len(self.camera_size) != 2 or min(self.camera_size) < 1:
            bad.append(Problem("verify", "camera_size", repr(self.camera_size), "width and height [pixel]"))
        if bad:
            raise InputError(bad)

    @property
    def pair_friction(self) -> float:
        """Coefficient that PyBullet is given: its pyramid has the sides μ, and so √2 μ at the corners."""
        return self.friction if self.friction_cone else self.friction / float(np.sqrt(2.0))

    def run(self, robot: RobotModel, timeline: Timeline, scene: Scene, progress: Progress | None = None) -> Trace:
        """Execute the timeline; SimulationError when PyBullet refuses the robot.

        Where a load is grasped, friction is Coulomb's cone with the iterations it wants: with the pyramid PyBullet
        leaves spinning friction out, and a box between two tips swings like a pendulum.  The closed chain wants more
        iterations than a stance does.
        """
        if any(entry.plan.holdings for entry in timeline.entries) and not self.friction_cone:
            exact = replace(
                self,
                friction_cone=True,
                solver_iterations=max(self.solver_iterations, CONE_ITERATIONS),
                solver_residual=min(self.solver_residual, CONE_RESIDUAL),
            )
            return exact.run(robot, timeline, scene, progress)
        plan = planned_rows(timeline, self.rate_hz)
        with direct_client(f"robot {robot.name}") as (p, client):
            p.setPhysicsEngineParameter(
                fixedTimeStep=1.0 / self.rate_hz,
                numSolverIterations=int(self.solver_iterations),
                solverResidualThreshold=self.solver_residual,
                deterministicOverlappingPairs=1,
                enableConeFriction=int(self.friction_cone),
                physicsClientId=client,
            )
            world = build_world(p, client, robot, scene, self.pair_friction)
            self._settle(world, robot, plan)
            recorder, sight = Recorder(world, len(plan.times)), SightLines(world, robot, timeline, scene, plan.times)
            feedback = AimFeedback(world, robot, timeline, plan, self.aim_feedback_hz)
            welder = Welder(world, welds_of(timeline))
            images = self._walk(world, robot, plan, recorder, sight, feedback, welder, progress)
            recording = replace(
                recorder.recording(plan.times, sight.free, images),
                camera_fov_deg=self.camera_fov_deg,
                aim_feedback_hz=self.aim_feedback_hz,
            )
        return assemble_trace(recording, plan, robot, timeline, scene)

    def _settle(self, world: World, robot: RobotModel, plan: TimelineSamples) -> None:
        """Spawn with the feet on the ground, and stand."""
        world.place_robot(spawn_pose(robot, plan), plan.joint_positions[0])
        still = np.zeros(len(robot.joint_names))
        for _ in range(round(self.settle_s * self.rate_hz)):
            self._command(world, robot, plan.joint_positions[0], still, plan.efforts[0])
            world.p.stepSimulation(physicsClientId=world.client)

    def _walk(
        self,
        world: World,
        robot: RobotModel,
        plan: TimelineSamples,
        recorder: Recorder,
        sight: SightLines,
        feedback: AimFeedback,
        welder: Welder,
        progress: Progress | None,
    ) -> list[tuple[float, bytes]]:
        """The loop; row k is the state at times[k], the step after it is commanded by row k of the plan."""
        rows, images = len(plan.times), []
        speeds = planned_speeds(plan, self.rate_hz)
        camera = next((tool for tool in robot.tools if tool.kind == "camera"), None)
        due = 0.0 if self.camera_hz > 0 and camera is not None else np.inf
        recorder.state(0)
        for row in range(rows):
            sight.look(row)
            welder.at(plan.times[row])
            if plan.times[row] >= due - 1e-9 and camera is not None:
                images.append(
                    (float(plan.times[row]), camera_picture(world, camera, self.camera_size, self.camera_fov_deg))
                )
                due += 1.0 / self.camera_hz
            ahead = self.velocity_feedforward * speeds[row]
            self._command(world, robot, feedback.positions(row), ahead, plan.efforts[row])
            world.p.stepSimulation(physicsClientId=world.client)
            recorder.contacts(row)
            recorder.state(row + 1)
            tell(progress, row + 1, rows)
        return images

    def _command(self, world: World, robot: RobotModel, positions: Array, velocities: Array, efforts: Array) -> None:
        set_motor: Any = world.p.setJointMotorControl2
        body, mode, client, gain = world.robot, world.p.POSITION_CONTROL, world.client, self.position_gain
        off, friction = world.p.VELOCITY_CONTROL, self.limp_friction
        rows = zip(world.joints, positions.tolist(), velocities.tolist(), efforts.tolist(), robot.velocity, strict=True)
        for joint, q, dq, effort, speed in rows:
            if not effort:  # a motor that is off resists every motion with its friction
                set_motor(body, joint, off, targetVelocity=0.0, force=friction, physicsClientId=client)
                continue
            set_motor(
                body,
                joint,
                mode,
                targetPosition=q,
                targetVelocity=dq,
                positionGain=gain,
                velocityGain=1.0,
                force=effort,
                maxVelocity=speed,
                physicsClientId=client,
            )
