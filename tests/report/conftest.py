"""The made-up run of the log tests."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest

from gaitforge.robot.load import load_robot
from gaitforge.verify.verdict import Verdict


@pytest.fixture(scope="session")
def verdict() -> Verdict:
    source = Path(__file__).parents[1] / "record" / "run_by_hand.py"
    spec = importlib.util.spec_from_file_location("run_by_hand", source)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.make_verdict(load_robot("hexapod"))
