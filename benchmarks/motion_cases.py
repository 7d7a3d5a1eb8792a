"""Motion problems to measure: shipped robots, robots with many limbs, random gaits."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

import gaitforge as gf
from gaitforge.errors import GaitforgeError
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion import gait as gaits
from gaitforge.motion.plan import Command
from gaitforge.motion.segment import Segment
from gaitforge.motion.stance import commanded_stance
from gaitforge.motion.trajectory import Discretisation
from gaitforge.resources import module_dirs
from gaitforge.robot.model import RobotModel

PORT = 0.125
"""[m] between neighbouring ports of a long body, as on the dodecapod"""


def segment(
    robot: RobotModel,
    pattern: FootfallPattern,
    samples_per_column: int = 2,
    command: Command | None = None,
    duration: float | None = None,
) -> Segment:
    """The gait as `plan_gait` would plan it from its nominal guess, not yet solved."""
    command = command or Command(robot.nominal.speed)
    stance = commanded_stance(robot, command, None)
    seconds = robot.nominal.duration if duration is None else duration
    grid = Discretisation(pattern, samples_per_column, seconds, command, stance=stance)
    walking = tuple(i for i, row in enumerate(pattern.contact) if row.any())
    fixed = gaits.resting_joints(robot, stance, walking, {}, {})
    guess = partial(gaits.nominal_guess, robot, stance, fixed)
    return Segment("gait", "gait", robot, grid, walking, fixed, guess, {})


def sized(robot: RobotModel, samples: int) -> Segment:
    """A gait on all limbs with two samples a column."""
    return segment(robot, gf.synthesize_gait_pattern(robot, columns=samples // 2))


def many_limbs(limbs: int, folder: Path) -> RobotModel:
    """Legs of the dodecapod on a body as long as they need, half of them on each side."""
    (folder / "modules").mkdir(parents=True)
    for file in module_dirs()["cmu_sea"].glob("*.yaml"):
        (folder / "modules" / file.name).write_bytes(file.read_bytes())
    places = [PORT * (limbs / 4 - 0.5 - k) for k in range(limbs // 2)]
    ports = [
        f"  {side}_{k}: {{type: sea, gender: male, xyz: [{x}, {y}, 0.0381], rpy: [-1.5707963267948966, 0, {turn}]}}"
        for side, y, turn in (("left", 0.0925, 0), ("right", -0.0925, 3.141592653589793))
        for k, x in enumerate(places, start=1)
    ]
    length = PORT * limbs / 2
    (folder / "modules" / "long_body.yaml").write_text(
        "format: 1\nname: long_body\nkind: chassis\nsource: the dodecapod's body, made longer for a benchmark\n"
        f"bodies:\n  body:\n    mass: {2.25 * length / 0.675}\n    shapes:\n"
        f"      - {{box: {{size: [{length}, 0.185, 0.0762]}}, xyz: [0, 0, 0.0381]}}\n"
        "ports:\n" + "\n".join(ports) + "\n",
        encoding="utf-8",
    )
    names = [
        (f"{s}{k}", f"{side}_{k}") for s, side in (("L", "left"), ("R", "right")) for k in range(1, limbs // 2 + 1)
    ]
    (folder / "robot.yaml").write_text(
        "format: 1\nchassis: long_body\nlimbs:\n  leg:\n    chain: [joint, joint, extension, joint, elbow_foot]\n"
        f"    mounts: {{{', '.join(f'{limb}: {port}' for limb, port in names)}}}\n"
        "nominal: {speed: 0.064, duration: 2.0, columns: 12, step_height: 0.03}\n",
        encoding="utf-8",
    )
    return gf.load_robot(folder / "robot.yaml")


@dataclass(frozen=True, eq=False)
class RandomGait:
    """A gait with everything drawn by lot."""

    robot: str
    limbs: int
    pattern: str
    command: Command
    segment: Segment


def random_gaits(count: int, seed: int) -> Iterator[RandomGait]:
    """Gaits on four to twelve limbs that have a footfall pattern, from the program and from waves."""
    rng = np.random.default_rng(seed)
    robots = {name: gf.load_robot(name) for name in ("hexapod", "dodecapod", "quadruped")}
    while count:
        name = str(rng.choice(list(robots), p=[0.4, 0.45, 0.15]))
        robot, everyone = robots[name], robots[name].limb_names
        keep = int(rng.integers(4 if len(everyone) < 12 else 5, len(everyone) + 1))
        walking = [everyone[i] for i in sorted(rng.choice(len(everyone), keep, replace=False))]
        wave, columns = bool(keep == 4 or rng.random() < 0.3), int(rng.integers(8, 13))
        speed = float(robot.nominal.speed * rng.uniform(0.3, 1.2))
        heading = float(rng.uniform(-np.pi, np.pi)) if rng.random() < 0.6 else 0.0
        turn = float(rng.uniform(-0.15, 0.15)) if rng.random() < 0.4 else 0.0
        try:
            pattern = (
                gf.synthesize_gait_pattern(robot, locomotive=walking, method="wave", columns=robot.nominal.columns)
                if wave
                else gf.synthesize_gait_pattern(robot, locomotive=walking, columns=columns)
            )
        except GaitforgeError:
            continue  # no pattern, no gait
        seconds = robot.nominal.duration * max(1.0, pattern.columns / 12)
        command = Command(speed, heading, turn)
        drawn = segment(robot, pattern, 2, command, seconds)
        kind = f"{'wave' if wave else 'program'}, {pattern.columns} columns"
        yield RandomGait(name, keep, kind, command, drawn)
        count -= 1
