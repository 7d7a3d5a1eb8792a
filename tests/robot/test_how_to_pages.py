"""The examples of the how-to pages work as they are printed."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from kit import write_robot
from test_recognition import bullet

from gaitforge.robot.load import load_robot

DOCS = Path(__file__).resolve().parents[2] / "docs"


def blocks(page: str, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", (DOCS / page).read_text(encoding="utf-8"), re.DOTALL)


def test_the_crawler_of_the_page_is_a_robot(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "robots" / "crawler").mkdir(parents=True)
    (tmp_path / "robots" / "crawler" / "robot.yaml").write_text(blocks("how_to_add_a_robot.md", "yaml")[0])
    monkeypatch.chdir(tmp_path)
    exec(blocks("how_to_add_a_robot.md", "python")[0], {})
    printed = capsys.readouterr().out
    assert [line.split()[:2] for line in printed.splitlines()[:4]] == [
        ["L1", "left"], ["L2", "left"], ["R1", "right"], ["R2", "right"],
    ]  # fmt: skip


def test_the_dog_of_the_page_is_a_robot(tmp_path: Path) -> None:
    text = blocks("how_to_add_a_robot.md", "yaml")[1]
    source = bullet("mini_cheetah/mini_cheetah.urdf")
    assert "urdf: mini_cheetah.urdf" in text
    (tmp_path / "robot.yaml").write_text(text.replace("mini_cheetah.urdf", str(source)))
    robot = load_robot(tmp_path / "robot.yaml")
    assert (robot.name, len(robot.limbs), set(robot.effort)) == ("little_dog", 4, {18.0})


def test_the_spacer_of_the_page_is_a_module(tmp_path: Path) -> None:
    (text,) = blocks("how_to_add_a_module.md", "yaml")
    chain = re.search(
        r"`(chain: \[joint, joint, \{module: spacer.*?\])`", (DOCS / "how_to_add_a_module.md").read_text()
    )
    assert chain is not None
    path = write_robot(tmp_path, "hexapod", ("chain: [joint, joint, extension, joint, elbow_foot]", chain.group(1)))
    (tmp_path / "modules" / "spacer.yaml").write_text(text)
    robot, plain = load_robot(path), load_robot("hexapod")
    assert robot.mass - plain.mass == pytest.approx(6 * (0.010 + 0.5 * 0.06), abs=1e-9)


@pytest.mark.parametrize("name", ["hexapod", "dodecapod", "quadruped"])
def test_the_page_of_a_robot_states_its_mass(name: str) -> None:
    page = (DOCS.parent / "robots" / name / "README.md").read_text(encoding="utf-8")
    assert f"{load_robot(name).mass:.3f} kg" in page


def test_the_format_page_names_every_key() -> None:
    from gaitforge.robot import module_read, nominal

    page = (DOCS.parent / "robots" / "FORMAT.md").read_text(encoding="utf-8")
    assert all(f"`{key}`" in page for key in (*module_read._KEYS, *nominal._KEYS) if key != "format")
