"""The family of docs/footfall.md lives in a package and a config folder outside the checkout."""

import json
import re
import textwrap
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "docs" / "footfall.md"


@pytest.fixture
def outside(tmp_path, monkeypatch):
    """A package and a config folder with what the page says, far from the checkout; the folder's path."""
    page = PAGE.read_text()
    (source,) = (b for b in re.findall(r"```python\n(.*?)```", page, re.DOTALL) if "class RearStance" in b)
    (option,) = (b for b in re.findall(r"```yaml\n(.*?)```", page, re.DOTALL) if "your_package.rear" in b)
    package, group = tmp_path / "lib" / "your_package", tmp_path / "conf" / "footfall" / "constraints"
    package.mkdir(parents=True)
    group.mkdir(parents=True)
    (package / "__init__.py").touch()
    (package / "rear.py").write_text(textwrap.dedent(source))
    (group / "g12_rear_stance.yaml").write_text(option)
    monkeypatch.syspath_prepend(str(package.parent))
    return str(tmp_path / "conf")


RUN = ("robot=hexapod", "task=walk", "+footfall/constraints=g12_rear_stance")


def test_a_family_from_another_package_is_one_class_and_one_file(gaitforge, outside):
    options = ("--allow-package", "your_package", "--config-dir", outside)
    finished = gaitforge(*options, *RUN, "footfall.constraints.g12.at_least=3")
    assert finished.code == 3, "only two rear limbs are there"
    (summary,) = finished.folder.rglob("summary.json")
    assert json.loads(summary.read_text())["explain"]["families"] == ["g12"]


def test_a_file_alone_does_not_bring_a_package_in(gaitforge, outside):
    finished = gaitforge("--config-dir", outside, *RUN)
    assert finished.code == 2
    assert "--allow-package" in finished.err
    assert finished.files == []


def test_the_page_says_how_to_allow_the_package():
    assert "--allow-package your_package --config-dir" in PAGE.read_text()
