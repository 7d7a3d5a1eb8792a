"""docs/motion.md and conf/motion say what the code does."""

from __future__ import annotations

import re
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import gaitforge as gf
from gaitforge.config.build import build
from gaitforge.errors import InputError
from gaitforge.motion.constraints.joint_speed import JointSpeed
from gaitforge.motion.family import Family
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import Command, MotionPlan
from gaitforge.motion.solvers.ipopt import Ipopt
from gaitforge.robot.model import RobotModel
from tests.motion.motion_kit import PENTA, TRIPOD, gait_segment, instance

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "motion.md").read_text(encoding="utf-8")
GROUP = ROOT / "conf" / "motion"


def blocks() -> list[str]:
    return re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)


@pytest.fixture(scope="module")
def page() -> dict[str, Any]:
    """The names that the how-to of the page makes, its gait included."""
    names: dict[str, Any] = {}
    _, *how_to = blocks()
    for block in how_to:
        exec(block, names)
    return names


def test_the_families_of_the_page_shape_the_gait(page: dict[str, Any], hexapod: RobotModel) -> None:
    def highest(plan: MotionPlan) -> float:
        corner = [*page["Headroom"]().point, 1.0]
        return max(
            (hexapod.link_pose("base_link", base, q) @ corner)[2]
            for base, q in zip(plan.base_poses, plan.joint_positions.T, strict=True)
        )

    assert issubclass(page["Headroom"], Family)
    free = gf.plan_gait(hexapod, page["gait"].pattern, samples_per_column=2)
    assert highest(free) > page["Headroom"]().height + 2e-3
    assert highest(page["gait"]) < page["Headroom"]().height + 1e-6
    stoop = np.abs(page["gait"].base_poses[:, 2] - page["Stoop"]().height).mean()
    assert stoop < np.abs(free.base_poses[:, 2] - page["Stoop"]().height).mean()


def test_the_families_of_the_page_have_right_derivatives(page: dict[str, Any], hexapod: RobotModel) -> None:
    options = MotionOptions(families=(page["Headroom"](), page["Stoop"]()))
    case = instance(gait_segment(hexapod, TRIPOD, Command(0.06)), options)
    families = {term.family for term in case.problem.terms}
    assert {"headroom", "stoop"} <= families
    for term in case.problem.terms:
        if term.family in ("headroom", "stoop"):
            v, p, h = case.x[term.variables[3]], term.parameters[3], 1e-6
            dense = np.zeros(len(v))
            dense[term.kernel.jacobian_rc[1]] = np.array(term.kernel.first(v, p)[1]).ravel()
            steps = h * np.eye(len(v))
            slope = [float(term.kernel.value(v + s, p) - term.kernel.value(v - s, p)) / (2 * h) for s in steps]
            assert dense == pytest.approx(slope, abs=1e-6)


def test_the_first_example_of_the_page_names_what_there_is() -> None:
    compile(blocks()[0], "docs/motion.md", "exec")
    for name in re.findall(r"gf\.(\w+)", "".join(blocks())):
        assert hasattr(gf, name), name


def test_the_page_lists_every_family(hexapod: RobotModel) -> None:
    case = instance(gait_segment(hexapod, PENTA, Command(0.06)))
    rows = {(name, unit) for name, unit in re.findall(r"^\| `(\w+)` \| .* \| ([^|]+) \| [^|]+ \|$", PAGE, re.M)}
    built = {(block.family, block.unit) for block in case.problem.rows} | {("progress", "m")}
    assert rows == built
    costs = re.findall(r"^\| `(\w+)` \| [^|]+ \| [^|]+ \|$", PAGE, re.M)
    assert set(costs) == {term.family for term in case.problem.terms if term.rows is None}


def test_options_that_the_page_names_exist() -> None:
    known = {f.name for f in fields(MotionOptions)}
    named = set(re.findall(r"`(\w+)`", PAGE))
    assert {n for n in named if n in known} >= {
        "height_range", "tilt_limit", "joint_margin", "stability_share", "progress_share", "ground_tolerance",
        "finest", "speed_share", "clearance", "refinements", "stand_seconds",
    }  # fmt: skip
    assert f"`ground_tolerance` ({MotionOptions().ground_tolerance * 1e3:g} mm)" in PAGE


def test_the_config_group_has_the_defaults_of_the_class() -> None:
    node = yaml.safe_load((GROUP / "default.yaml").read_text(encoding="utf-8"))
    listed = node.pop("defaults")
    built = build({**node, "solver": yaml.safe_load((GROUP / "solver" / "ipopt.yaml").read_text())}, MotionOptions)
    assert built == MotionOptions()
    assert {"solver": "ipopt"} in listed
    settable = {f.name for f in fields(MotionOptions)} - {"solver", "stability_share", "families"}
    assert settable == set(node) - {"_target_"}
    for name, value in node.items():
        default = getattr(MotionOptions(), name, None)
        if is_dataclass(default):
            assert set(value) == {"_target_", *(f.name for f in fields(default))}
    solver = yaml.safe_load((GROUP / "solver" / "ipopt.yaml").read_text(encoding="utf-8"))
    assert set(solver) == {"_target_", *(f.name for f in fields(Ipopt))}


@pytest.mark.parametrize("path", sorted(GROUP.rglob("*.yaml")), ids=lambda p: p.stem)
def test_every_parameter_has_a_comment_with_its_unit(path: Path) -> None:
    body = path.read_text(encoding="utf-8").split("_self_")[-1]
    for line in body.splitlines():
        key, _, value = line.partition(":")
        if value.split("#")[0].strip() and key.strip() != "_target_" and not key.strip().startswith(("-", "#")):
            assert "# [" in line, line


def test_families_come_from_a_config_too_and_nothing_else_does() -> None:
    target = "gaitforge.motion.options.MotionOptions"
    speed = {"_target_": "gaitforge.motion.constraints.joint_speed.JointSpeed", "share": 0.5}
    assert build({"_target_": target, "families": [speed]}, MotionOptions).families == (JointSpeed(0.5),)
    with pytest.raises(InputError, match="a constraint or cost family"):
        build({"_target_": target, "families": [{"_target_": "gaitforge.motion.plan.Command"}]}, MotionOptions)
