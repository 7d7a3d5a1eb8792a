"""docs/motion.md and conf/motion say what the code does."""

from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest
import yaml

import gaitforge as gf
from gaitforge.config.build import build
from gaitforge.errors import InputError
from gaitforge.motion.constraints.joint_speed import JointSpeed
from gaitforge.motion.costs.body import Body
from gaitforge.motion.family import Family
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import Command
from gaitforge.motion.solvers.ipopt import Ipopt
from gaitforge.robot.model import RobotModel
from tests.motion.motion_kit import PENTA, gait_segment, instance

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "motion.md").read_text(encoding="utf-8")
GROUP = ROOT / "conf" / "motion"


def blocks() -> list[str]:
    return re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)


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
        "height_range", "tilt_limit", "joint_margin", "stability_share", "ground_tolerance",
        "finest", "speed_share", "clearance", "refinements", "stand_seconds",
    }  # fmt: skip
    assert f"`ground_tolerance` ({MotionOptions().ground_tolerance * 1e3:g} mm;" in PAGE
    assert f"`change_tolerance`, {MotionOptions().change_tolerance * 1e3:g} mm)" in PAGE


def families(group: str) -> dict[str, dict[str, Any]]:
    """Option file → its one entry, with its key as "key"."""
    found = {}
    for path in sorted((GROUP / group).glob("*.yaml")):
        ((key, node),) = yaml.safe_load(path.read_text(encoding="utf-8")).items()
        found[path.stem] = {"key": key, **node}
    return found


def test_the_config_group_has_the_defaults_of_the_class() -> None:
    node = yaml.safe_load((GROUP / "default.yaml").read_text(encoding="utf-8"))
    listed = node.pop("defaults")
    (chosen,) = (d["constraints"] for d in listed if isinstance(d, dict) and "constraints" in d)
    (pulls,) = (d["costs"] for d in listed if isinstance(d, dict) and "costs" in d)
    for group, names in (("constraints", chosen), ("costs", pulls)):
        options = families(group)
        node[group] = [{k: v for k, v in options[name].items() if k != "key"} for name in names]
    built = build({**node, "solver": yaml.safe_load((GROUP / "solver" / "structured.yaml").read_text())}, MotionOptions)
    assert built == MotionOptions()
    assert {"solver": "structured"} in listed
    settable = {f.name for f in fields(MotionOptions)} - {"solver", "stability_share"}
    assert settable == set(node) - {"_target_"}
    solver = yaml.safe_load((GROUP / "solver" / "ipopt.yaml").read_text(encoding="utf-8"))
    assert set(solver) == {"_target_", *(f.name for f in fields(Ipopt))}


@pytest.mark.parametrize("group", ["constraints", "costs"])
def test_an_option_is_one_family_under_its_name_with_the_defaults_of_its_class(group: str) -> None:
    for stem, node in families(group).items():
        key = node.pop("key")
        family = build(node, Family)  # type: ignore[type-abstract]
        assert family == type(family)(), "the option file repeats the defaults"
        assert key == stem == family.name
        assert node["_target_"] == f"gaitforge.motion.{group}.{stem}.{type(family).__name__}"
        assert set(node) == {"_target_", *(f.name for f in fields(family))}  # type: ignore[arg-type]
        assert family.unit, family.enforced


@pytest.mark.parametrize("path", sorted(GROUP.rglob("*.yaml")), ids=lambda p: p.stem)
def test_every_parameter_has_a_comment_with_its_unit(path: Path) -> None:
    body = path.read_text(encoding="utf-8").split("_self_")[-1]
    for line in body.splitlines():
        key, _, value = line.partition(":")
        if value.split("#")[0].strip() and key.strip() != "_target_" and not key.strip().startswith(("-", "#")):
            assert "# [" in line, line


def test_families_come_from_a_config_and_nothing_else_does() -> None:
    target = "gaitforge.motion.options.MotionOptions"
    speed = {"_target_": "gaitforge.motion.constraints.joint_speed.JointSpeed", "share": 0.5}
    assert build({"_target_": target, "constraints": [speed]}, MotionOptions).constraints == (JointSpeed(0.5),)
    with pytest.raises(InputError, match="a constraint or cost family"):
        build({"_target_": target, "costs": [{"_target_": "gaitforge.motion.plan.Command"}]}, MotionOptions)


def test_the_command_line_chooses_drops_and_changes_families() -> None:
    from hydra import compose, initialize_config_dir

    from gaitforge.cli.options import options
    from gaitforge.config import register
    from gaitforge.resources import conf_dir, robot_files

    register({name: str(file) for name, file in robot_files().items()})
    overrides = ["motion/constraints=[kinematics,rolling,balance,joint_speed]", "~motion.costs.sharing",
                 "motion.costs.body.drift=50"]  # fmt: skip
    with initialize_config_dir(version_base="1.3", config_dir=str(conf_dir())):
        motion = options(compose("config", overrides), ()).motion
    assert motion is not None
    assert [f.name for f in motion.constraints] == ["kinematics", "rolling", "balance", "joint_speed"]
    assert [f.name for f in motion.costs] == ["smoothness", "posture", "body", "swing"]
    assert next(f.drift for f in motion.costs if isinstance(f, Body)) == 50
