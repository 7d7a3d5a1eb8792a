"""From "limb 4 is gone" to two checked plans: `python -m benchmarks.online [--robot dodecapod] [--repeats 5]`.

Every limb of the robot is lost in turn from its nominal gait; `gaitforge.recover` plans the next gait and the
transition.  Hot: the problem's structure has been seen before, as in a second loss of the same limb.
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from statistics import median

import gaitforge as gf
from gaitforge.motion.solvers.ipopt import Ipopt
from gaitforge.motion.solvers.structured import Structured

PAGE = Path(__file__).parent.parent / "docs" / "results" / "online.md"
STAGES = ("gait_pattern", "gait", "transition_pattern", "transition")


@dataclass(frozen=True)
class Row:
    """One limb lost, medians over the repeats."""

    limb: str
    pattern: str
    iterations: tuple[int, int]
    refinements: int
    wall_ms: float
    processor_ms: float
    stages_ms: dict[str, float]
    solve_ms: float
    margin_mm: float


def measure(robot: gf.RobotModel, gait: gf.MotionPlan, limb: str, repeats: int, options: gf.MotionOptions) -> Row:
    """Recover from the loss of one limb: once to warm up, then `repeats` times."""
    gf.recover(robot, gait, [limb], options=options)
    walls, processor, found = [], [], []
    for _ in range(repeats):
        wall, cpu = time.perf_counter(), time.process_time()
        found.append(gf.recover(robot, gait, [limb], options=options))
        walls.append(time.perf_counter() - wall)
        processor.append(time.process_time() - cpu)
    last = found[-1]
    plans = (last.gait, last.transition)
    return Row(
        limb,
        str(last.gait.pattern.info.get("operation", last.gait.pattern.source)),
        (last.gait.report.iterations, last.transition.report.iterations),
        sum(int(p.report.details["refinements"]) for p in plans),
        1e3 * median(walls),
        1e3 * median(processor),
        {stage: 1e3 * median(r.seconds[stage] for r in found) for stage in STAGES},
        1e3 * median(r.gait.report.seconds + r.transition.report.seconds for r in found),
        1e3 * min(float(p.report.details["zmp_margin_m"]) for p in plans),
    )


def page(robot: gf.RobotModel, rows: Sequence[Row], reference: Row, command: str) -> str:
    """The result as Markdown."""
    load = ", ".join(f"{v:.1f}" for v in os.getloadavg())
    middle, worst = median(r.processor_ms for r in rows), max(r.processor_ms for r in rows)
    lines = [
        "# From a lost limb to two checked plans",
        "",
        f"`{command}`, {datetime.now(UTC):%Y-%m-%d}, one thread, load {load} on {os.cpu_count()} processors.",
        "",
        f"{robot.name}, {len(robot.limbs)} limbs: each limb lost in turn from the nominal gait, "
        "`gaitforge.recover` plans the next gait and the transition into it, dense checks included. Hot. "
        "Processor time leads, since other work on the machine stretches the clock.",
        "",
        f"**Median {middle:.0f} ms of processor time (worst {worst:.0f} ms), "
        f"{median(r.wall_ms for r in rows):.0f} ms by the clock.** With IPOPT instead of the structured solver, limb "
        f"{reference.limb}: {reference.processor_ms:.0f} ms, "
        f"{reference.processor_ms / next(r for r in rows if r.limb == reference.limb).processor_ms:.1f} times as long.",
        "",
        "| lost | pattern | iterations: gait, transition | refinements | processor [ms] | clock [ms] "
        "| gait pattern | gait | transition pattern | transition | of these build and solve | margin [mm] |",
        "|---|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for r in rows:
        stages = " | ".join(f"{r.stages_ms[stage]:.0f}" for stage in STAGES)
        lines.append(
            f"| {r.limb} | {r.pattern} | {r.iterations[0]}, {r.iterations[1]} | {r.refinements} "
            f"| {r.processor_ms:.0f} | {r.wall_ms:.0f} | {stages} | {r.solve_ms:.0f} | {r.margin_mm:.0f} |"
        )
    lines += ["", "Stages are by the clock; *margin* is the smallest of the zero-moment point in both plans.", ""]
    return "\n".join(lines)


def main() -> None:
    """Measure and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robot", default="dodecapod")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--limbs", nargs="*")
    parser.add_argument("--out", type=Path, default=PAGE)
    asked = parser.parse_args()
    robot, fast = gf.load_robot(asked.robot), gf.MotionOptions(solver=Structured())
    gait = gf.plan_gait(robot, gf.synthesize_gait_pattern(robot, columns=robot.nominal.columns), options=fast)
    rows = []
    for limb in asked.limbs or robot.limb_names:
        rows.append(measure(robot, gait, limb, asked.repeats, fast))
        print(f"{limb}: {rows[-1].processor_ms:.0f} ms processor, {rows[-1].wall_ms:.0f} ms clock", flush=True)
    reference = measure(robot, gait, rows[0].limb, 1, replace(fast, solver=Ipopt()))
    command = f"python -m benchmarks.online --robot {asked.robot} --repeats {asked.repeats}"
    asked.out.write_text(page(robot, rows, reference, command), encoding="utf-8")


if __name__ == "__main__":
    main()
