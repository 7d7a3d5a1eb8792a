"""One log of a made-up dodecapod run, written once."""

from __future__ import annotations

from pathlib import Path

import pytest
from run_by_hand import SCENE, START_NS, make_verdict

from gaitforge.record import write_log
from gaitforge.record.reader import RunLog, read_run
from gaitforge.robot.load import load_robot
from gaitforge.robot.model import RobotModel
from gaitforge.verify.verdict import Verdict


@pytest.fixture(scope="session")
def dodecapod() -> RobotModel:
    return load_robot("dodecapod")


@pytest.fixture(scope="session")
def verdict(dodecapod: RobotModel) -> Verdict:
    return make_verdict(dodecapod)


@pytest.fixture(scope="session")
def log_path(tmp_path_factory: pytest.TempPathFactory, dodecapod: RobotModel, verdict: Verdict) -> Path:
    path = tmp_path_factory.mktemp("log") / "run.mcap"
    write_log(path, dodecapod, verdict, scene=SCENE, metadata={"seed": "7"}, start_time_ns=START_NS)
    return path


@pytest.fixture(scope="session")
def log(log_path: Path) -> RunLog:
    return read_run(log_path)
