"""The wheel carries the package, the config and the robots, and nothing that git does not know."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
SHIPPED = {"gaitforge": "gaitforge", "hydra_plugins": "hydra_plugins", "conf": "gaitforge/conf",
           "robots": "gaitforge/robots"}  # fmt: skip


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    ignored = REPOSITORY / "conf" / "__pycache__"
    ignored.mkdir(exist_ok=True)
    (ignored / "secret.yaml").write_text("a file that git ignores\n")
    try:
        subprocess.run(
            [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)],
            cwd=REPOSITORY, check=True, capture_output=True,
        )  # fmt: skip
    finally:
        (ignored / "secret.yaml").unlink()
        ignored.rmdir()
    (built,) = folder.glob("gaitforge-*.whl")
    return built


def test_every_file_of_package_config_and_robots_is_in_the_wheel(wheel: Path) -> None:
    expected = {
        f"{target}/{file.relative_to(REPOSITORY / source)}"
        for source, target in SHIPPED.items()
        for file in (REPOSITORY / source).rglob("*")
        if file.is_file() and "__pycache__" not in file.parts
    }
    names = {n for n in zipfile.ZipFile(wheel).namelist() if ".dist-info/" not in n}
    assert names == expected
    assert "gaitforge/conf/task/walk.yaml" in names
    assert "gaitforge/robots/hexapod/robot.yaml" in names


def test_the_wheel_works_from_its_own_files_in_any_folder(wheel: Path, tmp_path: Path) -> None:
    unpacked, elsewhere = tmp_path / "site", tmp_path / "elsewhere"
    elsewhere.mkdir()
    zipfile.ZipFile(wheel).extractall(unpacked)
    # The unpacked wheel goes before an editable install of the checkout.
    code = (
        f"import sys; sys.path.insert(0, {str(unpacked)!r})\n"
        "import gaitforge.resources as r\n"
        "from gaitforge.cli import main\n"
        "print(r.conf_dir())\n"
        "print(r.robot_files()['hexapod'])\n"
        "sys.exit(main(['robot=hexapod', 'task.speed=2.0']))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=elsewhere, capture_output=True, text=True, check=False)
    lines = done.stdout.splitlines()
    assert lines[0] == str(unpacked / "gaitforge" / "conf")
    assert lines[1] == str(unpacked / "gaitforge" / "robots" / "hexapod" / "robot.yaml")
    assert done.returncode == 3, done.stderr
    assert list(elsewhere.glob("outputs/hexapod/walk/*/summary.json"))


def test_the_constraints_pin_exact_versions_and_no_address() -> None:
    lines = (REPOSITORY / "constraints.txt").read_text().splitlines()
    pins = [line for line in lines if line and not line.startswith("#")]
    assert len(pins) > 50
    assert all(line.count("==") == 1 and not set(line) & set("/@;: ") for line in pins)
