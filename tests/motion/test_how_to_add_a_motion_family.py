"""The story of docs/how_to_add_a_motion_family.md is true, from the class to the command line."""

from __future__ import annotations

import re
import shlex
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import gaitforge as gf
from gaitforge.config.build import build
from gaitforge.motion.family import Family
from gaitforge.motion.plan import Command, MotionPlan
from gaitforge.robot.model import RobotModel
from tests.motion.motion_kit import TRIPOD, gait_segment, instance

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "how_to_add_a_motion_family.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the page's module and its option file."""
    folder = tmp_path_factory.mktemp("yours")
    (folder / "under_a_bar.py").write_text("".join(blocks("python")[:2]), encoding="utf-8")
    option = folder / "my_conf" / "motion" / "constraints" / "headroom.yaml"
    option.parent.mkdir(parents=True)
    option.write_text(blocks("yaml")[0], encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def page() -> dict[str, Any]:
    """The names that the page's Python makes, its gait included."""
    names: dict[str, Any] = {}
    for block in blocks("python"):
        exec(block, names)
    return names


def test_the_families_of_the_page_shape_the_gait(page: dict[str, Any], hexapod: RobotModel) -> None:
    def highest(plan: MotionPlan) -> float:
        corner = [*page["Headroom"]().point, 1.0]
        return max(
            (hexapod.link_pose("base_link", base, q) @ corner)[2]
            for base, q in zip(plan.base_poses, plan.joint_positions.T, strict=True)
        )

    free = gf.plan_gait(hexapod, page["gait"].pattern, samples_per_column=2)
    assert highest(free) > page["Headroom"]().height + 2e-3
    assert highest(page["gait"]) < page["Headroom"]().height + 1e-6
    stoop = np.abs(page["gait"].base_poses[:, 2] - page["Stoop"]().height).mean()
    assert stoop < np.abs(free.base_poses[:, 2] - page["Stoop"]().height).mean()


def test_the_table_of_the_page_shows_the_bar_at_work(page: dict[str, Any]) -> None:
    rows = {row.family: row for row in page["gait"].report.table}
    assert rows["headroom"].rows == len(page["gait"].times) - 1
    assert 0.0 < rows["headroom"].active <= 1.0
    assert (rows["stoop"].rows, rows["stoop"].active) == (0, None)


def test_the_families_of_the_page_have_right_derivatives(page: dict[str, Any], hexapod: RobotModel) -> None:
    case = instance(gait_segment(hexapod, TRIPOD, Command(0.06)), page["options"])
    for term in case.problem.terms:
        if term.family in ("headroom", "stoop"):
            v, p, h = case.x[term.variables[3]], term.parameters[3], 1e-6
            dense = np.zeros(len(v))
            dense[term.kernel.jacobian_rc[1]] = np.array(term.kernel.first(v, p)[1]).ravel()
            steps = h * np.eye(len(v))
            slope = [float(term.kernel.value(v + s, p) - term.kernel.value(v - s, p)) / (2 * h) for s in steps]
            assert dense == pytest.approx(slope, abs=1e-6)


def test_the_option_file_makes_the_class(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(package))
    ((key, node),) = yaml.safe_load(blocks("yaml")[0]).items()
    family = build(node, Family, allow=("under_a_bar",))
    assert (key, family.name) == ("headroom", "headroom")
    assert family == type(family)()


def test_the_command_line_of_the_page_walks_under_the_bar(
    package: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from gaitforge.cli import main

    monkeypatch.syspath_prepend(str(package))
    monkeypatch.chdir(package)
    _, *arguments = shlex.split(blocks("sh")[0].replace("\\\n", " "))
    fast = ["task.phases.0.cycles=2", "motion.samples_per_column=2", "motion.finest=2", "task.gait=tripod"]
    assert main([*arguments, *fast]) in (0, 1)
    printed = capsys.readouterr().out
    assert re.search(r"^headroom +constraint +\d+", printed, re.MULTILINE), printed
