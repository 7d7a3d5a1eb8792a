"""Bad input: one or two lines that name file, key, found and expected; the exit code; nothing left behind."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
import yaml

from gaitforge.resources import conf_dir, module_dirs, robot_files
from tests.conftest import Finished

Run = Callable[..., Finished]

TASKS = ", ".join(sorted(file.stem for file in (conf_dir() / "task").glob("*.yaml")))


def refused(finished: Finished, *words: str, code: int = 2, lines: int = 2) -> None:
    """The run ended with `code`, said every word on stderr in few lines, and left nothing."""
    assert finished.code == code
    assert "Traceback" not in finished.err
    assert 1 <= len(finished.err.strip().splitlines()) <= lines
    for word in words:
        assert word in finished.err
    assert finished.files == []


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["robot=octopus"], ["robot", "'octopus'", "dodecapod, hexapod, quadruped"]),
        (["task=dance"], ["task", "'dance'", TASKS]),
        (["task.sped=0.05"], ["task.sped", "unknown key", "speed"]),
        (["task.phases.0.cycels=3"], ["task.phases[0].cycels", "unknown key", "cycles"]),
        (["sed=3"], ["sed", "unknown key", "seed"]),
        (["verify.frictoin=1.0"], ["verify.frictoin", "unknown key", "friction"]),
        (["motion.step_hight=0.1"], ["motion.step_hight", "unknown key", "step_height"]),
        (["task.speed=fast"], ["task.speed", "'fast'", "number"]),
        (["verify.friction=slippery"], ["verify.friction", "'slippery'", "number"]),
        (["record.rate_hz=0"], ["record", "rate_hz"]),
        (["task.speed=-0.1"], ["task=walk", "speed", "-0.1", "≥ 0"]),
        (["task.phases.0.cycles=0"], ["task=walk", "phases.0.cycles", "0", "≥ 1"]),
        (["task.gait=gallop"], ["gait", "'gallop'", "auto, tripod, wave, program"]),
        (["+task.phases.0.roles.R9=held"], ["phases.0.roles.R9", "no limb", "L1, L2, L3, R1, R2, R3"]),
        (["task=camera_only"], ["phases.1.roles.camera", "no limb and no tool", "L1"]),
        (["robot=dodecapod", "task=camera_leg", "task.scene.0.name=tube"], ["'pipe.opening'", "tube.opening"]),
        (["+task.phases.0.roles.R1={role: tool, look_at: [1, 0, 0]}"], ["R1", "camera"]),
        (["record._target_=os.getcwd"], ["record._target_", "'os.getcwd'", "gaitforge", "--allow-package"]),
        (["=="], ["command line"]),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) and "=" in value[0] else "",
)  # fmt: skip
def test_a_wrong_word_on_the_command_line_is_named(gaitforge: Run, arguments: list[str], words: list[str]) -> None:
    refused(gaitforge(*arguments), *words)


def test_all_problems_of_a_task_are_reported_together(gaitforge: Run) -> None:
    finished = gaitforge("task.speed=-1", "task.phases.0.cycles=-2", "+task.phases.0.roles.R9=held")
    refused(finished, "speed", "phases.0.cycles", "phases.0.roles.R9", lines=3)


def test_an_output_folder_that_cannot_be_made_is_refused(gaitforge: Run, tmp_path: Path) -> None:
    blocked = tmp_path / "blocked"
    blocked.write_text("a file where a folder should be\n")
    refused(gaitforge("robot=hexapod", f"outputs={blocked}"), str(blocked))
    assert blocked.read_text() == "a file where a folder should be\n"


def test_a_folder_that_the_user_had_is_left_as_it_was(gaitforge: Run, tmp_path: Path) -> None:
    mine = tmp_path / "mine"
    mine.mkdir()
    (mine / "notes.txt").write_text("keep me\n")
    finished = gaitforge("task.phases.0.cycles=0", f"hydra.run.dir={mine}")
    assert finished.code == 2
    assert [p.name for p in mine.iterdir()] == ["notes.txt"]


@pytest.fixture
def own_robots(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A user's folder with a module family and a robot that can be spoilt."""
    folder = tmp_path / "robots"
    shutil.copytree(module_dirs()["cmu_sea"], folder / "modules" / "cmu_sea")
    (folder / "crab").mkdir()
    shutil.copy(robot_files()["hexapod"], folder / "crab" / "robot.yaml")
    monkeypatch.setenv("GAITFORGE_ROBOTS", str(folder))
    return folder


def edit(file: Path, change: Callable[[dict], None]) -> None:
    data = yaml.safe_load(file.read_text())
    change(data)
    file.write_text(yaml.safe_dump(data))


def test_the_user_s_robot_is_sound_before_it_is_spoilt(own_robots: Path) -> None:
    from gaitforge.robot.load import load_robot

    assert load_robot("crab").modules == 20


def test_a_module_with_negative_mass_is_refused(gaitforge: Run, own_robots: Path) -> None:
    edit(own_robots / "modules/cmu_sea/joint.yaml", lambda m: m["bodies"]["input"].update(mass=-0.1))
    refused(gaitforge("robot=crab"), "joint.yaml", "bodies.input.mass", "-0.1", "kg", lines=3)


def test_ports_that_do_not_fit_are_refused(gaitforge: Run, own_robots: Path) -> None:
    edit(own_robots / "modules/cmu_sea/joint.yaml", lambda m: m["ports"]["in"].update(type="hebi_x"))
    refused(gaitforge("robot=crab"), "robot.yaml", "hebi_x", lines=9)


def test_a_limb_that_carries_a_tool_but_does_not_exist_is_refused(gaitforge: Run, own_robots: Path) -> None:
    edit(own_robots / "crab/robot.yaml", lambda r: r.update(tools={"L9": "gripper"}))
    refused(gaitforge("robot=crab"), "robot.yaml", "L9", "L1", lines=3)


def test_a_misspelt_key_in_a_robot_is_refused(gaitforge: Run, own_robots: Path) -> None:
    edit(own_robots / "crab/robot.yaml", lambda r: r["nominal"].update(sped=0.1))
    refused(gaitforge("robot=crab"), "robot.yaml", "nominal.sped", "speed", lines=3)


def test_a_misspelt_key_in_a_task_of_the_user_is_refused(gaitforge: Run, tmp_path: Path) -> None:
    (tmp_path / "conf" / "task").mkdir(parents=True)
    (tmp_path / "conf" / "task" / "mine.yaml").write_text("phases: [{name: a, cycels: 3}]\n")
    refused(gaitforge("--config-dir", str(tmp_path / "conf"), "task=mine"), "task/mine", "cycels", "cycles")
