"""Every constraint and cost family at random points against its equation, written out in the world frame."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pinocchio
import pytest

from gaitforge.motion.bodies import BASE
from gaitforge.motion.constraints import Progress
from gaitforge.motion.costs import Body, Pace, Posture, Sharing, Smoothness, SwingProfile
from gaitforge.motion.plan import Command
from gaitforge.motion.trajectory import Discretisation
from gaitforge.robot.model import RobotModel
from tests.motion.motion_kit import CHANGE, PENTA, Instance, gait_segment, instance, near_pairs, open_segment

GRAVITY = 9.81
COMMAND = Command(0.06, 0.4, 0.5)


@pytest.fixture(scope="module")
def gait_case(hexapod: RobotModel) -> Instance:
    return instance(gait_segment(hexapod, PENTA, COMMAND, r=2))


@pytest.fixture(scope="module")
def change_case(hexapod: RobotModel) -> Instance:
    return instance(open_segment(hexapod, CHANGE, "transition", r=2, seed=5), seed=5)


@pytest.fixture(scope="module")
def uneven_case(uneven: RobotModel) -> Instance:
    return instance(gait_segment(uneven, PENTA, COMMAND, r=2))


@pytest.fixture(params=["gait_case", "change_case", "uneven_case"])
def case(request: pytest.FixtureRequest) -> Instance:
    found: Instance = request.getfixturevalue(request.param)
    return found


@dataclass(frozen=True, eq=False)
class Path:
    """All samples in the world, one more on either side of a gait."""

    first: int
    """number of the first entry's sample"""
    turn: np.ndarray
    """(n,) yaw of each sample's frame [rad]"""
    base: np.ndarray
    joints: np.ndarray
    com: np.ndarray
    feet: np.ndarray


def path_of(case: Instance, span: int = 1) -> Path:
    """The variables of a random point carried into the world, sample −span … K + span in a gait."""
    trajectory, grid, x = case.trajectory, case.trajectory.grid, case.x
    joints = np.tile(trajectory.fixed_joints, (grid.samples, 1))
    feet = np.full((grid.samples, len(trajectory.robot.limbs), 3), np.nan)
    for i in trajectory.moving:
        joints[:, trajectory.robot.joint_indices(trajectory.robot.limbs[i])] = x[trajectory.joints[i]]
        feet[:, i] = x[trajectory.feet[i]]
    base, com = x[trajectory.base], x[trajectory.com]
    order = np.arange(-span, grid.samples + span) if grid.cyclic else np.arange(grid.samples)
    turn = np.zeros(len(order))
    out = Path(int(order[0]), turn, base[order % grid.samples].copy(), joints[order % grid.samples],
               com[order % grid.samples].copy(), feet[order % grid.samples].copy())  # fmt: skip
    if grid.cyclic:
        for n, k in enumerate(order):
            x0, y0, turn[n] = circle(grid.command, k * grid.dt)
            for points in (out.base[n : n + 1, :3], out.com[n : n + 1], out.feet[n]):
                points[:, :2] = points[:, :2] @ plane(turn[n]).T + [x0, y0]
            out.base[n, 5] += turn[n]
    return out


def plane(angle: float) -> np.ndarray:
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def circle(command: Command, t: float) -> np.ndarray:
    """x, y, yaw after t: a body that turns drives around the centre that lies v/ω beside its velocity."""
    w = command.yaw_rate
    if not w:
        return np.array([command.speed * t * np.cos(command.heading), command.speed * t * np.sin(command.heading), 0.0])
    centre = command.speed / w * np.array([-np.sin(command.heading), np.cos(command.heading)])
    return np.array([*(centre - plane(w * t) @ centre), w * t])


def second_differences(values: np.ndarray, grid: Discretisation, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """(K, …) accelerations; at an open end that of the parabola with the given end velocity."""
    h = grid.dt
    if grid.cyclic:
        return (values[:-2] - 2 * values[1:-1] + values[2:]) / h**2
    inner = (values[:-2] - 2 * values[1:-1] + values[2:]) / h**2
    first = 2 * ((values[1] - values[0]) / h - start) / h
    last = 2 * (end - (values[-1] - values[-2]) / h) / h
    return np.concatenate([first[None], inner, last[None]])


def rows_of(case: Instance, family: str) -> np.ndarray:
    """The rows of one family at the random point."""
    values = case.problem.constraint_values(case.x)
    return np.concatenate([values[b.start : b.start + len(b.lower)] for b in case.problem.rows if b.family == family])


def cost_of(case: Instance, family: str) -> float:
    return sum(
        float(term.kernel.value(case.x[v], p))
        for term in case.problem.terms
        if term.rows is None and term.family == family
        for v, p in zip(term.variables, term.parameters, strict=True)
    )


def ends(case: Instance, what: str, size: int) -> tuple[np.ndarray, np.ndarray]:
    grid = case.trajectory.grid
    start, end = (np.zeros(size) if e is None else getattr(e, what) for e in (grid.start, grid.end))
    return start, end


def inner(path: Path, samples: int) -> slice:
    return slice(-path.first, -path.first + samples)


def test_kinematic_rows_vanish_where_pinocchio_puts_feet_and_centre_of_mass(any_robot: RobotModel) -> None:
    from gaitforge.footfall.pattern import FootfallPattern

    n = len(any_robot.limbs)
    contact = np.array([[(k + i) % 2 for k in range(4)] for i in range(n)], dtype=bool)
    contact[0] = False  # a limb that does not move counts in the base
    case = instance(gait_segment(any_robot, FootfallPattern(contact, any_robot.limb_names), COMMAND))
    trajectory, x = case.trajectory, case.x.copy()
    base = x[trajectory.base]
    assert np.abs(base[:, 3:]).max() > 0.05
    joints = np.tile(trajectory.fixed_joints, (len(base), 1))
    for limb in any_robot.limbs:  # a tool is weighed at its nominal position
        tools = [any_robot.joint_names.index(name) for name in limb.tool_joints]
        joints[:, tools] = any_robot.nominal.posture[tools]
    for i in trajectory.moving:
        joints[:, any_robot.joint_indices(any_robot.limbs[i])] = x[trajectory.joints[i]]
    for k in range(len(base)):
        feet = any_robot.foot_positions(base[k], joints[k])
        for i in trajectory.moving:
            x[trajectory.feet[i][k]] = feet[i]
        x[trajectory.com[k]] = any_robot.center_of_mass(base[k], joints[k])
    there = replace(case, x=x)
    assert np.abs(rows_of(there, "kinematics")).max() < 1e-9
    assert np.abs(rows_of(there, "center_of_mass")).max() < 1e-9
    assert np.abs(rows_of(case, "kinematics")).max() > 1e-2


def test_balance_rows_are_the_moment_of_the_weights_about_the_centre_of_pressure(case: Instance) -> None:
    trajectory, grid, path = case.trajectory, case.trajectory.grid, path_of(case)
    acceleration = second_differences(path.com, grid, *ends(case, "com_velocity", 3))
    here = inner(path, grid.samples)
    com, feet, turn = path.com[here], path.feet[here], path.turn[here]
    rows = rows_of(case, "balance").reshape(-1, 3)
    assert len(rows) == len(trajectory.weights)
    for (k, limbs, index), row in zip(trajectory.weights, rows, strict=True):
        w, a = case.x[index], acceleration[k]
        lift = 1 + a[2] / GRAVITY
        pressure = com[k, :2] - com[k, 2] / (GRAVITY + a[2]) * a[:2]  # x − z/(g + z̈) ẍ
        moment = lift * pressure - w @ feet[k, list(limbs), :2]
        origin = circle(grid.command, k * grid.dt)[:2] if grid.cyclic else np.zeros(2)
        moment -= (lift - w.sum()) * origin  # rows speak of the sample's own frame
        assert plane(turn[k]) @ row[:2] == pytest.approx(moment, abs=1e-9)
        assert row[2] == pytest.approx(w.sum() - lift, abs=1e-9)


def test_progress_asks_for_a_share_of_the_commanded_way(change_case: Instance, gait_case: Instance) -> None:
    (block,) = (b for b in change_case.problem.rows if b.family == "progress")
    grid = change_case.trajectory.grid
    way = Progress().share * grid.command.speed * grid.duration
    assert (block.lower.tolist(), block.upper.tolist()) == ([pytest.approx(way)], [np.inf])
    base = change_case.x[change_case.trajectory.base]
    middle = grid.command.heading + grid.command.yaw_rate * grid.duration / 2
    assert rows_of(change_case, "progress") == pytest.approx(
        [(base[-1, :2] - base[0, :2]) @ [np.cos(middle), np.sin(middle)]]
    )
    assert not any(b.family == "progress" for b in gait_case.problem.rows)


def test_joint_speed_bounds_the_mean_speed_of_every_interval(case: Instance) -> None:
    trajectory, grid, path = case.trajectory, case.trajectory.grid, path_of(case)
    robot, here = trajectory.robot, inner(path, grid.intervals)
    moves = np.concatenate([robot.joint_indices(robot.limbs[i]) for i in trajectory.moving])
    step = np.diff(path.joints, axis=0)[here][:, moves]
    limit = 0.7 * robot.velocity[moves] * grid.dt
    blocks = [b for b in case.problem.rows if b.family == "joint_speed"]
    upper = np.hstack([b.upper.reshape(grid.intervals, -1) for b in blocks])
    assert upper == pytest.approx(np.tile(limit, (grid.intervals, 1)))
    assert np.hstack([b.lower.reshape(grid.intervals, -1) for b in blocks]) == pytest.approx(-upper)
    values = case.problem.constraint_values(case.x)
    found = np.hstack([values[b.start : b.start + len(b.lower)].reshape(grid.intervals, -1) for b in blocks])
    assert found == pytest.approx(step)


def test_clearance_rows_are_squared_distances_of_material_points(case: Instance) -> None:
    trajectory, grid, robot = case.trajectory, case.trajectory.grid, case.trajectory.robot
    joints = path_of(case, 0).joints
    segment = gait_segment(robot, PENTA, COMMAND, r=2)
    if not grid.cyclic:
        segment = open_segment(robot, CHANGE, "transition", r=2, seed=5)
    pairs = near_pairs(segment, segment.make_guess(segment.grid), 12)
    blocks = [b for b in case.problem.rows if b.family == "clearance"]
    values = np.concatenate([np.ravel(rows) for rows in rows_of(case, "clearance")])
    labels = [label for block in blocks for label in block.labels]
    lower = np.concatenate([block.lower for block in blocks])
    assert len(pairs) == len(values) == 12
    expected = []
    for pair in pairs:
        k = pair.sample % grid.samples
        data = robot.pin.createData()
        pinocchio.forwardKinematics(robot.pin, data, robot.configuration(np.zeros(6), joints[k]))
        points = []
        for capsule, point in ((pair.first, pair.first_point), (pair.second, pair.second_point)):
            assert capsule.limb != BASE
            name = robot.limbs[capsule.limb].joints[capsule.joint]
            points.append(data.oMi[robot.pin.getJointId(name)].act(point))
        label = f"{pair.first.name}–{pair.second.name} at sample {k}"
        floor = (pair.first.radius + pair.second.radius + 0.004) ** 2
        expected.append((label, np.sum((points[0] - points[1]) ** 2), floor))
    found = sorted(zip(labels, values, lower, strict=True))
    for (label, value, low), (name, square, floor) in zip(found, sorted(expected), strict=True):
        assert label == name
        assert value == pytest.approx(square, abs=1e-9)
        assert low == pytest.approx(floor)
    assert trajectory.moving


def test_smoothness_is_the_squared_acceleration_over_time(case: Instance) -> None:
    trajectory, grid, path = case.trajectory, case.trajectory.grid, path_of(case)
    cost = Smoothness()
    seconds = np.full(grid.samples, grid.dt)
    if not grid.cyclic:
        seconds[[0, -1]] /= 2
    moves = np.concatenate([trajectory.robot.joint_indices(trajectory.robot.limbs[i]) for i in trajectory.moving])
    speeds = ends(case, "joint_velocity", len(trajectory.robot.joint_names))
    joints = second_differences(path.joints[:, moves], grid, *(v[moves] for v in speeds))
    base = second_differences(path.base, grid, *ends(case, "base_velocity", 6))
    expected = cost.joints * seconds @ (joints**2).sum(axis=1)
    expected += cost.position * seconds @ (base[:, :3] ** 2).sum(axis=1)
    expected += cost.rotation * seconds @ (base[:, 3:] ** 2).sum(axis=1)
    assert cost_of(case, "smoothness") == pytest.approx(expected, rel=1e-9)


def test_posture_pulls_to_the_standing_posture_and_harder_on_the_ground(case: Instance) -> None:
    trajectory, grid = case.trajectory, case.trajectory.grid
    robot, cost, expected = trajectory.robot, Posture(), 0.0
    for i in trajectory.moving:
        rows = robot.joint_indices(robot.limbs[i])
        away = ((case.x[trajectory.joints[i]] - robot.nominal.posture[rows]) ** 2).sum(axis=1)
        weight = np.array([cost.stance if down else cost.swing for down in grid.ground[:, i]])
        expected += grid.dt * float(weight @ away)
    assert cost_of(case, "posture") == pytest.approx(expected, rel=1e-9)


def test_body_pulls_to_height_level_line_and_course(gait_case: Instance, change_case: Instance) -> None:
    weights = Body()
    for case in (gait_case, change_case):
        trajectory, grid = case.trajectory, case.trajectory.grid
        base, expected = path_of(case, 0).base, 0.0
        for k, pose in enumerate(base):
            way = circle(grid.command, k * grid.dt)
            start = np.zeros(6) if grid.start is None else grid.start.base
            if grid.cyclic:  # the line goes through the moving frame, along the velocity
                off, along = pose[:2] - way[:2], grid.command.heading + way[2]
            else:  # the line leaves the start
                off, along = pose[:2] - start[:2], grid.command.heading + start[5]
            drift = np.cos(along) * off[1] - np.sin(along) * off[0]
            yaw = pose[5] - start[5] - way[2]
            height = pose[2] - trajectory.robot.nominal.body_height
            tilt = pose[3] ** 2 + pose[4] ** 2 + yaw**2
            expected += weights.height * height**2 + weights.orientation * tilt + weights.drift * drift**2
        assert cost_of(case, "body") == pytest.approx(grid.dt * expected, rel=1e-9)


def test_pace_is_the_squared_deviation_from_the_commanded_velocity(hexapod: RobotModel) -> None:
    command = Command(0.06, 0.4)
    case = instance(gait_segment(hexapod, PENTA, command, r=2), more=(Pace(7.0),))
    grid, path = case.trajectory.grid, path_of(case).base[1:, :2]  # from sample 0 to the first one of the next cycle
    off = np.diff(path, axis=0) / grid.dt - 0.06 * np.array([np.cos(0.4), np.sin(0.4)])
    assert cost_of(case, "pace") == pytest.approx(7.0 * grid.dt * (off**2).sum(), rel=1e-9)


def test_a_body_that_turns_as_commanded_keeps_its_pace(hexapod: RobotModel) -> None:
    case = instance(gait_segment(hexapod, PENTA, COMMAND, r=2), more=(Pace(),))
    assert cost_of(case, "pace") > 0.01
    case.x[case.trajectory.base] = [0.02, -0.03, 0.13, 0.0, 0.0, 0.0]
    assert cost_of(case, "pace") == 0.0


def test_pace_says_nothing_of_a_transition(hexapod: RobotModel) -> None:
    case = instance(open_segment(hexapod, CHANGE, "transition", r=2, seed=5), seed=5, more=(Pace(),))
    assert not any(term.family == "pace" for term in case.problem.terms)


def test_sharing_pulls_the_weights_to_equal_shares(case: Instance) -> None:
    trajectory = case.trajectory
    expected = sum(float(((case.x[index] - 1 / len(feet)) ** 2).sum()) for _, feet, index in trajectory.weights)
    expected *= Sharing().weight * trajectory.grid.dt
    assert cost_of(case, "sharing") == pytest.approx(expected, rel=1e-9)


def test_swinging_feet_are_pulled_to_a_path_from_lift_to_landing(case: Instance) -> None:
    trajectory, grid = case.trajectory, case.trajectory.grid
    robot, path = trajectory.robot, path_of(case, grid.samples)
    height = robot.nominal.step_height
    expected, counted = 0.0, 0
    for i in trajectory.moving:
        ground = grid.ground[:, i]
        for k in range(grid.samples):
            reach = range(1, grid.samples)
            if grid.cyclic:
                back = next((n for n in reach if ground[(k - n) % grid.samples]), None)
                ahead = next((n for n in reach if ground[(k + n) % grid.samples]), None)
            else:
                back = next((n for n in reach if k - n >= 0 and ground[k - n]), None)
                ahead = next((n for n in reach if k + n < grid.samples and ground[k + n]), None)
            if ground[k] or back is None or ahead is None:
                continue
            s, at = back / (back + ahead), k - path.first
            lift, now, land = (path.feet[n, i] for n in (at - back, at, at + ahead))
            u = 1 - abs(2 * s - 1)
            up, done = (v**3 * (10 - 15 * v + 6 * v**2) for v in (u, s))
            expected += (now[2] - robot.limbs[i].foot.radius - 1.1 * height * up) ** 2
            expected += float(((now[:2] - (1 - done) * lift[:2] - done * land[:2]) ** 2).sum())
            counted += 1
    assert counted > 10
    assert cost_of(case, "swing") == pytest.approx(SwingProfile().weight * grid.dt * expected, rel=1e-9)
