"""Every option of every config group composes, and its objects can be built."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml
from hydra import compose, initialize_config_dir
from omegaconf import OmegaConf

from gaitforge.cli.options import options
from gaitforge.config import plain, register
from gaitforge.resources import conf_dir, robot_files
from gaitforge.robot.load import load_robot
from gaitforge.task.load import load_task

CONF = conf_dir()
FILES = sorted(p.relative_to(CONF).with_suffix("") for p in CONF.rglob("*.yaml") if p.parent != CONF)
SINGLE = [p for p in FILES if p.parent.name != "constraints"]
FAMILIES = [p for p in FILES if p.parent.name == "constraints"]


def composed(*overrides: str):
    register({name: str(file) for name, file in robot_files().items()})
    with initialize_config_dir(str(CONF), version_base="1.3"):
        return compose("config", list(overrides))


@pytest.mark.parametrize("option", SINGLE, ids=str)
def test_an_option_composes_and_its_objects_are_built(option: Path) -> None:
    node = composed(f"{option.parent}={option.name}")
    built = options(node, ())
    assert built.simulator.name
    assert built.motion is not None


@pytest.mark.parametrize("option", FAMILIES, ids=str)
def test_a_run_with_one_constraint_family_alone_is_built_with_it_alone(option: Path) -> None:
    built = options(composed(f"{option.parent}=[{option.name}]"), ())
    chosen = built.motion.constraints if option.parts[0] == "motion" else built.footfall["constraints"]
    assert len(chosen) == 1


@pytest.mark.parametrize("robot", sorted(robot_files()))
def test_every_robot_folder_is_an_option_that_loads(robot: str) -> None:
    node = composed(f"robot={robot}")
    assert load_robot(node.robot.file).name == robot


@pytest.mark.parametrize("task", sorted(p.name for p in FILES if p.parent.name == "task"))
def test_every_task_is_read_from_the_composed_config(task: str) -> None:
    robot = "dodecapod" if task in ("camera_leg", "camera_only", "carry_large") else "hexapod"
    node = composed(f"task={task}")
    read = load_task(plain(node.task), task, robot=load_robot(robot))
    source = yaml.safe_load((CONF / "task" / f"{task}.yaml").read_text())
    assert [p.name for p in read.phases] == [p["name"] for p in source["phases"]]
    given = {p["name"]: p["cycles"] for p in source["phases"] if "cycles" in p}
    assert {p.name: p.cycles for p in read.phases if p.name in given} == given


def test_the_command_line_reaches_a_phase_that_its_file_says_nothing_about() -> None:
    node = composed("task=walk", "task.phases.0.speed=0.05", "task.columns=18")
    task = load_task(plain(node.task), "walk", robot=load_robot("hexapod"))
    assert task.phases[0].speed == 0.05
    assert task.phases[0].columns == 18


def test_a_robot_in_a_folder_of_the_user_is_an_option(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "crab").mkdir()
    (tmp_path / "crab" / "robot.yaml").write_text(robot_files()["hexapod"].read_text())
    monkeypatch.setenv("GAITFORGE_ROBOTS", str(tmp_path))
    assert composed("robot=crab").robot.file == str(tmp_path / "crab" / "robot.yaml")


def test_every_parameter_in_the_config_has_a_comment() -> None:
    bare = [
        f"{file.relative_to(CONF)}: {line.strip()}"
        for file in CONF.rglob("*.yaml")
        for line in file.read_text().splitlines()
        if file.name != "config.yaml"
        and ":" in line.split("#")[0]
        and not line.split("#")[0].rstrip().endswith(":")
        and "_target_" not in line
        and not line.lstrip().startswith("- ")  # an entry of a defaults list
        and "#" not in line
    ]
    assert bare == []


def test_the_whole_config_survives_a_round_trip_through_yaml() -> None:
    node = composed("task=camera_leg")
    assert OmegaConf.create(OmegaConf.to_yaml(node)) == OmegaConf.create(plain(node))
