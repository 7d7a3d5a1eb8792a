"""The commands that `benchmarks.commands` asks for, and what became of one of them."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

ROBOTS = ("hexapod", "dodecapod")
HEADINGS_DEG = tuple(range(0, 360, 45))
SPEEDS = (0.03, 0.064, 0.09)
"""[m/s]"""
YAW_DEG_S = 8.0
"""[°/s] on the spot and along an arc, both ways"""
ARC_SPEED = 0.05
"""[m/s]"""
HEIGHTS = (-0.03, 0.0, 0.025)
"""[m] off the nominal body height"""
STEPS = (0.02, 0.035, 0.05)
"""[m]"""
CYCLES = 3
VELOCITY_PERCENT, YAW_LIMIT_DEG_S = 5.0, 2.0
"""What a plan that is called feasible has to keep in simulation."""
ITERATIONS = 500
"""Of the contact solver in every step, in a second look at gaits that turn (by default it ends at a residual)"""
STILL_MM_S = 2.5
"""[mm/s] on the spot there is no speed to take a percentage of: 5 % of an `ARC_SPEED`"""


@dataclass(frozen=True)
class Case:
    """One command to one robot."""

    robot: str
    group: str
    speed: float = 0.0
    heading_deg: float = 0.0
    yaw_deg_s: float = 0.0
    body_height: float | None = None
    step_height: float | None = None

    @property
    def key(self) -> str:
        """Unique among the cases."""
        return "|".join(str(value) for value in asdict(self).values())


@dataclass(frozen=True)
class Row:
    """What became of a case."""

    case: Case
    status: str
    """walks · misses · refused"""
    why: str = ""
    families: tuple[str, ...] = ()
    plan_s: float = 0.0
    """[s] of processor time"""
    velocity_percent: float | None = None
    """|measured − commanded| velocity over commanded; None on the spot"""
    velocity_mm_s: float | None = None
    yaw_error_deg_s: float | None = None
    failed: tuple[str, ...] = ()
    """Checks of the simulated gait that fail besides"""
    values: dict[str, float] = field(default_factory=dict)

    def as_dict(self) -> dict[str, Any]:
        """JSON types."""
        return asdict(self)


def row_of(data: dict[str, Any]) -> Row:
    """The row that `Row.as_dict` was made of."""
    case = Case(**data["case"])
    return Row(**{**data, "case": case, "families": tuple(data["families"]), "failed": tuple(data["failed"])})


def cases(robot: str, nominal_height: float) -> Iterator[Case]:
    """Heading–speed pairs, turning, body heights, step heights."""
    for heading in HEADINGS_DEG:
        for speed in SPEEDS:
            yield Case(robot, "velocity", speed, float(heading))
    for yaw in (YAW_DEG_S, -YAW_DEG_S):
        yield Case(robot, "on the spot", 0.0, 0.0, yaw)
        yield Case(robot, "along an arc", ARC_SPEED, 0.0, yaw)
    for off in HEIGHTS:
        yield Case(robot, "body height", 0.064, body_height=round(nominal_height + off, 4))
    for step in STEPS:
        yield Case(robot, "step height", 0.064, step_height=step)


def measure(case: Case) -> Row:
    """Plan the case, walk it in PyBullet, and compare the velocities."""
    import gaitforge as gf
    from gaitforge.errors import InfeasibleMotion, UnsolvedError

    robot = gf.load_robot(case.robot)
    pattern = gf.synthesize_gait_pattern(robot, method="tripod")
    begin = time.process_time()
    try:
        gait = gf.plan_gait(
            robot, pattern, speed=case.speed, heading=np.radians(case.heading_deg),
            yaw_rate=np.radians(case.yaw_deg_s), body_height=case.body_height, step_height=case.step_height,
        )  # fmt: skip
    except (InfeasibleMotion, UnsolvedError) as error:
        families = tuple(error.explain.get("families", ()))
        return Row(case, "refused", str(error), families, time.process_time() - begin)
    seconds = time.process_time() - begin
    verdict = gf.verify(robot, [(gait, CYCLES)])
    percent, millimetres, yaw = velocity_errors(case, gait, verdict)
    keeps = (percent <= VELOCITY_PERCENT if percent is not None else millimetres <= STILL_MM_S) and (
        yaw <= YAW_LIMIT_DEG_S
    )
    fell = any(check.name == "fallen" for check in verdict.failed)
    checks = {c.name: c.value for c in verdict.checks if c.segment == gait.name and c.value is not None}
    details = gait.report.details
    values = {
        "speed_ratio": details["speed_ratio"], "effort_planned": details["effort_ratio"],
        "zmp_margin_mm": 1e3 * details["zmp_margin_m"], "samples_per_column": gait.samples_per_column,
        "height_m": float(gait.base_poses[:-1, 2].mean()),
        "lift_mm": 1e3 * float((gait.feet[:-1, :, 2].max(axis=0) - gait.feet[:-1, :, 2].min(axis=0)).min()),
        "slip_mm": checks["slip"], "tilt_deg": checks["tilt"], "effort_measured": checks["effort_ratio"],
    }  # fmt: skip
    if case.yaw_deg_s:
        values |= converged(robot, case, gait)
    return Row(
        case, "walks" if keeps and not fell else "misses", "; ".join(gait.relaxed), (), seconds, percent, millimetres,
        yaw, tuple(c.name for c in verdict.failed if c.segment == gait.name),
        {key: round(float(value), 4) for key, value in values.items()},
    )  # fmt: skip


def converged(robot: Any, case: Case, gait: Any) -> dict[str, float]:
    """The same gait with all iterations of the contact solver in every step: slip [mm], failed checks, errors."""
    import gaitforge as gf
    from gaitforge.verify.pybullet import PyBulletSimulator

    verdict = gf.verify(
        robot, [(gait, CYCLES)], simulator=PyBulletSimulator(solver_iterations=ITERATIONS, solver_residual=0.0)
    )
    _, millimetres, yaw = velocity_errors(case, gait, verdict)
    slip = next(c.value for c in verdict.checks if c.segment == gait.name and c.name == "slip")
    failed = sum(c.segment == gait.name for c in verdict.failed)
    return {"slip_converged_mm": slip, "failed_converged": failed, "velocity_converged_mm_s": millimetres,
            "yaw_converged_deg_s": yaw}  # fmt: skip


def velocity_errors(case: Case, gait: Any, verdict: Any) -> tuple[float | None, float, float]:
    """(|Δv| [% of the command], |Δv| [mm/s], |Δ yaw rate| [°/s]) over whole cycles, the first left out.

    A cycle's displacement in the frame of the body at its start is compared with where the command
    leads in that time: along a line, an arc, or nowhere.
    """
    from gaitforge.motion.trajectory import planar_motion

    trace, entry = verdict.trace, next(e for e in verdict.timeline.entries if e.plan.kind == "gait")
    goal = planar_motion(gait.command, gait.duration)
    moved = []
    for turn in range(1, entry.cycles):
        first, last = (
            int(np.argmin(np.abs(trace.times - (entry.start + k * gait.duration)))) for k in (turn, turn + 1)
        )
        moved.append(_moved(trace.base_poses[first], trace.base_poses[last], float(gait.base_poses[0, 5])))
    mean = np.mean(moved, axis=0)
    off = float(np.linalg.norm(mean[:2] - goal[:2])) / gait.duration
    yaw = abs(float(np.degrees(mean[2] - goal[2]))) / gait.duration
    return (100.0 * off / case.speed if case.speed else None), 1e3 * off, yaw


def _moved(first: NDArray[np.float64], last: NDArray[np.float64], offset: float) -> NDArray[np.float64]:
    """(3,) x, y [m] and yaw [rad] from one pose to another, in the frame of the commanded body at the first.

    `offset`: by how much the body's yaw differs from the command's there, by plan.
    """
    yaw = first[5] - offset
    step, c, s = last[:2] - first[:2], np.cos(yaw), np.sin(yaw)
    return np.array([c * step[0] + s * step[1], c * step[1] - s * step[0], last[5] - first[5]])
