"""One walking cycle of a quadruped, gaitforge beside Crocoddyl: the same URDF, contacts, speed and step height.

``python -m benchmarks.motion_crocoddyl --python <python of the other environment> [--repeats 9] [--out file.md]``

Crocoddyl runs in an environment of its own (benchmarks/README.md tells how it is made); both exchange a JSON file.
Crocoddyl begins with the first state of gaitforge's plan at every node, gaitforge with its nominal guess.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from statistics import median
from typing import Any

import gaitforge as gf
from benchmarks.motion import table
from gaitforge.footfall.pattern import FootfallPattern

PAGE = Path(__file__).parents[1] / "docs" / "results" / "motion_crocoddyl.md"
WALK = Path(__file__).parent / "crocoddyl_walk.py"
ROBOT = "solo_description/robots/solo12.urdf"
NODES_PER_COLUMN = (4, 8, 16)
SOON = 1e-3
"""[s] after the start: where the robot is then tells its velocity"""
PROMISES = (
    (
        "dynamics",
        "a point mass above the CoP; torques and the full ZMP are reported",
        "whole body",
    ),
    ("contact forces", "implied by the CoP in the shrunk polygon", "planned, friction cones as a cost"),
    ("joint limits, clearances, swing height, reach", "hard inequalities", "costs"),
    ("end of the cycle", "the beginning, positions and velocities (periodic)", "pulled to by costs"),
    ("footholds", "chosen by the optimiser", "given"),
    ("between samples", "checked densely, refined where a bound is missed", "an integration step, nothing checked"),
)


@dataclass(frozen=True)
class Own:
    """gaitforge's plan and its times."""

    plan: gf.MotionPlan
    processor: tuple[float, ...]
    """[s] of each repeat of `plan_gait`"""
    wall: tuple[float, ...]
    """[s] the same by the clock"""


def example(name: str) -> Path:
    """A URDF of the example-robot-data wheel; raises FileNotFoundError when it is not there."""
    for file in metadata.files("example-robot-data") or ():
        if str(file).endswith(f"robots/{name}"):
            return Path(str(file.locate())).resolve()
    raise FileNotFoundError(name)


def timed(robot: gf.RobotModel, pattern: FootfallPattern, repeats: int) -> Own:
    """Hot: the first plan is not timed."""
    plan = gf.plan_gait(robot, pattern)
    processor, wall = [], []
    for _ in range(repeats):
        begin, clock = time.process_time(), time.perf_counter()
        plan = gf.plan_gait(robot, pattern)
        processor.append(time.process_time() - begin)
        wall.append(time.perf_counter() - clock)
    return Own(plan, tuple(processor), tuple(wall))


def request(robot: gf.RobotModel, plan: gf.MotionPlan, urdf: Path, repeats: int) -> dict[str, Any]:
    """What Crocoddyl is asked for, as JSON: SI units, limbs in the order of C."""

    def moment(t: float) -> dict[str, Any]:
        joints = dict(zip(robot.joint_names, plan(t).tolist(), strict=True))
        return {"base": plan.base_spline(t).tolist(), "joints": joints}

    return {
        "urdf": str(urdf),
        "contact": plan.pattern.contact.astype(int).tolist(),
        "duration": plan.duration,
        "speed": plan.speed,
        "step_height": robot.nominal.step_height if plan.command.step_height is None else plan.command.step_height,
        "friction": 1.0,
        "feet": [{"link": limb.foot.link, "offset": list(limb.foot.offset)} for limb in robot.limbs],
        "start": moment(0.0),
        "soon": moment(SOON),
        "soon_seconds": SOON,
        "nodes_per_column": list(NODES_PER_COLUMN),
        "most_iterations": 500,
        "repeats": repeats,
    }


def answered(python: Path, asked: Mapping[str, Any]) -> dict[str, Any]:
    """What the other environment replies, with one thread."""
    with tempfile.TemporaryDirectory() as folder:
        question, reply = Path(folder) / "request.json", Path(folder) / "reply.json"
        question.write_text(json.dumps(asked), encoding="utf-8")
        # its own packages only: a PYTHONPATH of this environment would lend it the wrong Pinocchio
        environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"} | {"OMP_NUM_THREADS": "1"}
        subprocess.run([python, WALK, question, reply], check=True, env=environment)
        return dict(json.loads(reply.read_text(encoding="utf-8")))


def compared(own: Own, reply: Mapping[str, Any]) -> list[str]:
    """The table: gaitforge, then Crocoddyl at every grid."""
    report = own.plan.report
    mine = median(own.processor)
    rows = [
        [
            "gaitforge",
            f"{len(own.plan.times) - 1} samples",
            f"**{1e3 * mine:.0f}**",
            f"{1e3 * median(own.wall):.0f}",
            "1",
            report.iterations,
            f"{1e3 * report.details['slip_m']:.1f}",
            f"{1e3 * report.details['penetration_m']:.1f}",
            "0",
            "0",
        ]
    ]
    for plan in reply["plans"]:
        seconds = median(plan["processor_s"])
        rows.append(
            [
                "Crocoddyl",
                f"{plan['nodes']} nodes of {1e3 * plan['dt']:.0f} ms",
                f"**{1e3 * seconds:.0f}** (+ {1e3 * median(plan['build_s']):.0f})",
                f"{1e3 * median(plan['wall_s']):.0f}",
                f"{seconds / mine:.1f}",
                f"{plan['iterations']}{'' if plan['solved'] else ', not converged'}",
                f"{1e3 * plan['slip_m']:.1f}",
                f"{1e3 * plan['penetration_m']:.1f}",
                f"{1e3 * plan['landing_error_m']:.1f}",
                f"{plan['cyclic_gap_rad']:.3f}",
            ]
        )
    head = ["", "grid", "processor ms", "wall ms", "ratio", "iterations", "slip mm", "below ground mm"]
    return table([*head, "foothold missed mm", "joints at the end against the start rad"], rows)


def page(asked: Mapping[str, Any], own: Own, reply: Mapping[str, Any]) -> str:
    """The result as Markdown."""
    plan, pattern = own.plan, own.plan.pattern
    known = ", ".join(f"{name} {metadata.version(name)}" for name in ("casadi", "qdldl", "pin"))
    theirs = ", ".join(f"{name} {version}" for name, version in reply["versions"].items())
    first = plan.report.details["refined"][0]
    plans, repeats, robot = reply["plans"], asked["repeats"], Path(asked["urdf"]).stem
    out = max(0.0, *(p["cone_excess_N"] for p in plans))
    lift = min(p["lift_m"] for p in plans)
    order = " ".join(pattern.info["order"])
    stride = f"{plan.duration:.1f} s, {plan.speed:.3f} m/s, steps of {1e3 * plan.speed * plan.duration:.0f} mm"
    lines = [
        "# One walking cycle, gaitforge beside Crocoddyl",
        "",
        f"{datetime.now(UTC):%Y-%m-%d}, `python -m benchmarks.motion_crocoddyl --python … --repeats {repeats}`; "
        f"Python {platform.python_version()}, gaitforge on {known}, the other on {theirs}; {platform.machine()}, one "
        f"thread each, load {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors. Medians of {repeats} hot runs.",
        "",
        f"`{robot}` of example-robot-data, gaitforge's wave gait ({order}): {pattern.columns} columns, {stride}. "
        "Crocoddyl is given the contacts, the footholds and gaitforge's first state, and begins with that state at "
        "every node and the torques that hold it; gaitforge begins with its nominal guess.",
        "",
        "gaitforge's time is `plan_gait`: building, solving, every refinement and the dense checks; its iterations are "
        f"summed over the grids (the first one alone: {1e3 * first['seconds']:.0f} ms, {first['iterations']} "
        "iterations). Crocoddyl's is FDDP until it stops by itself; building its problem from Python stands behind the "
        "plus sign and is not in the ratio, for whoever plans again and again changes a built problem.",
        "",
        *compared(own, reply),
        "",
        "Slip of gaitforge is what the foot sphere does beyond rolling, between samples too; Crocoddyl's feet are "
        f"points that stand still. They rise by {1e3 * lift:.0f} mm at least (asked for: "
        f"{1e3 * asked['step_height']:.0f}), leave their friction cones by {out:.2f} N at most, and the largest "
        f"torque is {max(p['torque_Nm'] for p in plans):.1f} N m.",
        "",
        "The two do not promise the same:",
        "",
        *table(["", "gaitforge", "Crocoddyl, as posed here"], PROMISES),
        "",
        "So a ratio says what a walking cycle costs with either, not that one would do the other's work: gaitforge "
        "plans neither torques nor angular momentum, Crocoddyl has no hard limits and no periodicity unless they "
        "are added.",
        "",
    ]
    return "\n".join(lines)


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure and write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--python", type=Path, required=True, help="of the environment that has Crocoddyl")
    parser.add_argument("--repeats", type=int, default=9, help="of every hot measurement")
    parser.add_argument("--out", type=Path, default=PAGE, help="where the page goes")
    given = parser.parse_args(arguments)
    urdf = example(ROBOT)
    robot = gf.load_robot(urdf)
    own = timed(robot, gf.synthesize_gait_pattern(robot, method="wave"), given.repeats)
    asked = request(robot, own.plan, urdf, given.repeats)
    text = page(asked, own, answered(given.python, asked))
    given.out.write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
