"""Experiments from the command line: bad input, folders, the exit code."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from omegaconf import OmegaConf

from gaitforge.config.schema import run_folder
from tests.conftest import Finished

Run = Callable[..., Finished]


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("experiment=tabel1", "table1"),
        ("experiment.only=[nothing.*]", "hexapod.six_to_five.interpolate"),
        ("experiment.robots.hexapod.five.free=[L7]", "L7"),
        ("experiment.workers=0", "workers"),
        ("experiment.onyl=[]", "onyl"),
        ("experiment.accept=[{at_leest: {speed_share: 1}}]", "at_leest"),
        ("experiment.resume=nowhere", "nowhere"),
    ],
)
def test_bad_input_is_told_in_a_line_and_leaves_nothing(gaitforge: Run, override: str, message: str) -> None:
    named = [override] if override.startswith("experiment=") else ["experiment=table1", override]
    finished = gaitforge(*named)
    assert finished.code == 2
    assert message in finished.err
    assert "Traceback" not in finished.err
    assert finished.files == []


def test_an_experiment_has_a_folder_of_its_own_name_or_the_one_that_is_resumed() -> None:
    root = {"robot": {"name": "hexapod"}, "hydra": {"runtime": {"choices": {"task": "walk", "experiment": "table1"}}}}
    for experiment, expected in (
        (None, "out/hexapod/walk/now"),
        ({"resume": None}, "out/experiments/table1/now"),
        ({"resume": "earlier"}, "earlier"),
    ):
        config = OmegaConf.create({**root, "experiment": experiment})
        assert run_folder("out", "now", _root_=config) == expected
