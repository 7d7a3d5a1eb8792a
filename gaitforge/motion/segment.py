"""One segment from its discretisation to a solved plan: the engine under gaits, transitions and stands."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gaitforge.motion.family import Family
from gaitforge.motion.layout import lay_out
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import Command, Kind, MotionPlan
from gaitforge.motion.problem import Problem
from gaitforge.motion.report import SolveReport
from gaitforge.motion.solvers.solution import Solution, Start
from gaitforge.motion.trajectory import Discretisation, Guess, Trajectory, planar_motion
from gaitforge.robot.kinematics import feet_in_world
from gaitforge.robot.model import RobotModel
from gaitforge.task.roles import Role

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Segment:
    """What is to be planned: robot, grid, who moves, where to start looking."""

    name: str
    kind: Kind
    robot: RobotModel
    grid: Discretisation
    moving: tuple[int, ...]
    fixed_joints: Array
    make_guess: Callable[[Discretisation], Guess]
    """The starting point on a given grid."""
    roles: Mapping[str, Role]

    def on_grid(self, samples_per_column: int) -> Segment:
        """The same segment with more (or fewer) samples a column."""
        return replace(self, grid=replace(self.grid, samples_per_column=samples_per_column))

    def build(self, options: MotionOptions, extra: Sequence[Family] = ()) -> tuple[Problem, Trajectory]:
        """The motion problem with all families, those of the options and `extra` ones last."""
        problem = Problem()
        height = step_height(self.robot, self.grid.command, options)
        trajectory = lay_out(
            problem,
            self.robot,
            self.grid,
            self.moving,
            self.fixed_joints,
            self.make_guess(self.grid),
            step_height=height,
            minimum_weight=options.stability_share,
            tilt=options.tilt_limit,
            height_range=options.height_range,
            joint_margin=options.joint_margin,
        )
        for family in (*options.families, *extra):
            family.add_to(problem, trajectory)
        return problem, trajectory

    def solve(
        self, options: MotionOptions, extra: Sequence[Family] = (), start: Start = None
    ) -> tuple[Solution, MotionPlan]:
        """Build and solve; the plan is returned whether solved or not, the solution says which."""
        begin = time.perf_counter()
        problem, trajectory = self.build(options, extra)
        solution = options.solver.solve(problem, start)
        size = {"rows": problem.row_count, "variables": problem.size}
        plan = self._plan(trajectory, solution, time.perf_counter() - begin, size)
        if options.table:
            from gaitforge.motion.table import problem_table

            table = problem_table(problem, solution.x, (*options.families, *extra))
            plan = replace(plan, report=replace(plan.report, table=table))
        return solution, plan

    def _plan(self, trajectory: Trajectory, solution: Solution, seconds: float, size: Mapping[str, int]) -> MotionPlan:
        grid, x = self.grid, solution.x
        joints = np.tile(self.fixed_joints, (grid.samples, 1))
        for group in trajectory.alike:
            joints[:, group.rows] = x[group.joints].transpose(1, 0, 2)
        base = x[trajectory.base]
        if grid.cyclic:
            joints, base = np.vstack([joints, joints[:1]]), self._in_world(np.vstack([base, base[:1]]))
        ends = (grid.start, grid.end)
        speeds = None if grid.cyclic else np.array([e.joint_velocity for e in ends if e is not None])
        base_speeds = None if grid.cyclic else np.array([e.base_velocity for e in ends if e is not None])
        return MotionPlan(
            name=self.name,
            kind=self.kind,
            pattern=grid.pattern,
            times=np.asarray(np.arange(grid.intervals + 1) * grid.dt, dtype=float),
            joint_positions=joints.T.copy(),
            base_poses=base,
            com=self.robot.center_of_mass(base, joints),
            feet=feet_in_world(self.robot, base, joints),
            weights=_weights(trajectory, x),
            command=grid.command,
            roles=dict(self.roles),
            loads=self.robot.loads,
            stance=grid.stance,
            joint_velocity_ends=speeds,
            base_velocity_ends=base_speeds,
            report=SolveReport(solution.status, solution.iterations, seconds, solution.cost, solution.residual, size),
        )

    def _in_world(self, base: Array) -> Array:
        """Base poses in the moving frame, in the frame of the segment's start."""
        poses = np.array(base)
        x, y, yaw = planar_motion(self.grid.command, np.arange(len(poses)) * self.grid.dt).T
        c, s = np.cos(yaw), np.sin(yaw)
        poses[:, 0], poses[:, 1] = x + c * base[:, 0] - s * base[:, 1], y + s * base[:, 0] + c * base[:, 1]
        poses[:, 5] += yaw
        return poses


def step_height(robot: RobotModel, command: Command, options: MotionOptions) -> float:
    """[m] The command's, else the options', else the robot's own."""
    heights = (command.step_height, options.step_height, robot.nominal.step_height)
    return next(float(height) for height in heights if height is not None)


def _weights(trajectory: Trajectory, x: Array) -> Array:
    grid = trajectory.grid
    weights = np.zeros((grid.intervals + 1, 2, grid.contact.shape[1]))
    for k, feet, index in trajectory.weights:
        share = x[index] / x[index].sum()
        for side, interval in ((0, k - 1), (1, k)):
            if (grid.cyclic or 0 <= interval < grid.intervals) and grid.stance_feet(interval) == feet:
                weights[k, side, list(feet)] = share
    if grid.cyclic:
        weights[-1] = weights[0]
    return weights
