"""What the README promises: its links exist, its commands compose, and CI runs its test command."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
README = (REPOSITORY / "README.md").read_text()
COMMANDS = [line.split("#")[0].strip() for line in README.splitlines() if line.startswith("gaitforge ")]
PAGES = [p for p in (REPOSITORY / "README.md", REPOSITORY / "CONTRIBUTING.md", *REPOSITORY.glob("docs/*.md"))]


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_every_link_to_a_file_of_the_project_leads_somewhere(page: Path) -> None:
    targets = re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", page.read_text())
    local = [t for t in targets if "://" not in t]
    assert [t for t in local if not (page.parent / t).exists()] == []


@pytest.mark.parametrize("command", [c for c in COMMANDS if "--multirun" not in c and "--help" not in c])
def test_a_command_of_the_readme_composes(command: str, tmp_path: Path) -> None:
    arguments = [a for a in shlex.split(command)[1:] if a not in ("--cfg", "job")]
    done = subprocess.run(
        [sys.executable, "-m", "gaitforge", *arguments, "--cfg", "job"],
        cwd=tmp_path, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "phases:" in done.stdout


def test_there_are_two_lines_for_a_fresh_machine_and_ci_runs_the_second() -> None:
    fresh = [line for line in README.splitlines() if line.startswith("python3.11 -m venv")]
    assert len(fresh) == 2
    assert fresh[0].endswith("gaitforge robot=dodecapod task=camera_leg")
    assert fresh[1].endswith("pytest -n auto")
    pattern = re.search(r"grep -m1 -E '([^']+)' README.md", (REPOSITORY / ".ci" / "run").read_text())
    assert pattern is not None
    assert [line for line in README.splitlines() if re.match(pattern[1], line)] == [fresh[1]]


def test_every_package_and_config_group_of_the_table_exists() -> None:
    rows = re.findall(r"^\| [^|]+ \| `(gaitforge/\w+)` \| ([^|]+) \|", README, re.MULTILINE)
    assert len(rows) >= 6
    for package, groups in rows:
        assert (REPOSITORY / package).is_dir()
        for group in re.findall(r"`([\w/]+)=`", groups):
            assert (REPOSITORY / "conf" / group).is_dir() or group == "robot"
