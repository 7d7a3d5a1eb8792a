"""`config.build`, the one door to instantiation."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from omegaconf import OmegaConf

from gaitforge.config import build
from gaitforge.config.typecheck import fits
from gaitforge.errors import InputError
from gaitforge.pipeline.options import Search
from gaitforge.verify.checks import CheckLimits
from gaitforge.verify.pybullet import PyBulletSimulator
from gaitforge.verify.simulator import Simulator

SEARCH = "gaitforge.pipeline.options.Search"


def refusal(node: object, base: type = object, **more: object) -> str:
    with pytest.raises(InputError) as caught:
        build(node, base, key="part", file="config", **more)
    return str(caught.value)


def test_an_object_is_built_from_its_target_and_parameters() -> None:
    node = OmegaConf.create({"_target_": SEARCH, "gait_candidates": 3, "transition_stretch": [1.0, 2]})
    assert build(node, Search) == Search(gait_candidates=3, transition_stretch=(1.0, 2))


def test_a_simulator_is_recognised_by_what_it_can_do() -> None:
    node = {"_target_": "gaitforge.verify.pybullet.PyBulletSimulator", "friction": 0.7}
    made = build(node, Simulator)
    assert isinstance(made, PyBulletSimulator)
    assert made.friction == 0.7
    assert "a Simulator" in refusal({"_target_": SEARCH}, Simulator)


def test_values_below_a_parameter_reach_its_own_class() -> None:
    node = {"_target_": "gaitforge.verify.checks.limits.CheckLimits", "gait": {"slip_mm": 7.0}}
    assert build(node, CheckLimits).gait.slip_mm == 7.0


@pytest.mark.parametrize(
    "target",
    [
        "os.getcwd",
        "subprocess.Popen",
        "gaitforge_evil.Thing",
        "gaitforge",
        "gaitforge.cli.app.os.getcwd",
        "gaitforge.cli.app.sys",
        "gaitforge.record.files.Path",
        "gaitforge.record.files.os.system",
        "gaitforge.record.files.write_text",
        "gaitforge.nothing.Here",
        "gaitforge.pipeline.options.Nothing",
        "",
        17,
    ],
)
def test_nothing_but_a_class_defined_in_gaitforge_is_made(target: object) -> None:
    message = refusal({"_target_": target})
    assert message.startswith("config: part._target_: found ")


def test_a_target_inside_a_parameter_is_held_to_the_same_rule() -> None:
    message = refusal({"_target_": SEARCH, "gait_candidates": {"_target_": "os.getcwd"}})
    assert message.startswith("config: part.gait_candidates._target_: found 'os.getcwd'")


def test_a_package_is_allowed_when_the_command_line_names_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "mysearch.py").write_text(
        "from gaitforge.pipeline.options import Search\nclass Mine(Search):\n    pass\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    node = {"_target_": "mysearch.Mine"}
    assert "mysearch" not in sys.modules
    assert "--allow-package" in refusal(node)
    assert "mysearch" not in sys.modules, "a refused package is not even imported"
    assert type(build(node, Search, allow=("mysearch",))).__name__ == "Mine"


def test_the_wrong_type_of_object_is_refused() -> None:
    assert "found Search; expected a PyBulletSimulator" in refusal({"_target_": SEARCH}, PyBulletSimulator)


def test_every_wrong_parameter_is_named_at_once() -> None:
    node = {"_target_": SEARCH, "gait_candidate": 3, "transition_candidates": "many", "transition_stretch": [True]}
    message = refusal(node)
    assert len(message.splitlines()) == 3
    assert "part.gait_candidate: found an unknown key; expected one of gait_candidates" in message
    assert "part.transition_candidates: found 'many'; expected a whole number" in message
    assert "part.transition_stretch" in message


def test_what_a_class_refuses_itself_is_told_with_its_words() -> None:
    assert "at least one candidate" in refusal({"_target_": SEARCH, "gait_candidates": 0})


@pytest.mark.parametrize(
    ("value", "hint", "expected"),
    [
        (1, float, True), (1.5, int, False), (True, int, False), (True, float, False), ("1", float, False),
        (None, float | None, True), ("a", float | None, False), ([1.0, 2.0], tuple[float, ...], True),
        ([1.0], tuple[float, float], False), ("ab", tuple[str, ...], False), ([1, "x"], list[int], False),
        ({}, dict, True), (1, bool, False), ("x", str, True),
    ],
)  # fmt: skip
def test_a_value_fits_its_type_hint_or_does_not(value: object, hint: object, expected: bool) -> None:
    assert fits(value, hint) is expected
