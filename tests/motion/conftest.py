"""Robots and plans that many tests look at; each is planned once."""

from __future__ import annotations

import numpy as np
import pytest

import gaitforge as gf
from gaitforge.motion.plan import MotionPlan
from gaitforge.robot.model import RobotModel
from tests.motion.motion_kit import CHANGE, PATIENT, PENTA, TRIPOD
from tests.robot.kit import shipped, write_robot

TUCKED = (0.2, 0.6, 0.3)
"""[rad] where R1 is held in the gait on five limbs."""


@pytest.fixture(scope="session")
def hexapod() -> RobotModel:
    return gf.load_robot("hexapod")


@pytest.fixture(scope="session")
def quadruped() -> RobotModel:
    return gf.load_robot("quadruped")


@pytest.fixture(scope="session")
def dodecapod() -> RobotModel:
    return gf.load_robot("dodecapod")


@pytest.fixture(scope="session")
def uneven(tmp_path_factory: pytest.TempPathFactory) -> RobotModel:
    """A hexapod whose middle legs have a joint more than the others."""
    legs = "    mounts: {L1: left_1, L2: left_2, L3: left_3, R1: right_1, R2: right_2, R3: right_3}\n"
    middle = (
        "    mounts: {L1: left_1, L3: left_3, R1: right_1, R3: right_3}\n"
        "  middle:\n    chain: [joint, joint, joint, extension, joint, elbow_foot]\n"
        "    mounts: {L2: left_2, R2: right_2}\n"
    )
    text = shipped("hexapod")
    postures = text[text.index("  posture:") : text.index("  speed:")]
    return gf.load_robot(write_robot(tmp_path_factory.mktemp("uneven"), "hexapod", (legs, middle), (postures, "")))


@pytest.fixture(scope="session", params=["hexapod", "quadruped", "dodecapod", "uneven"])
def any_robot(request: pytest.FixtureRequest) -> RobotModel:
    robot: RobotModel = request.getfixturevalue(request.param)
    return robot


@pytest.fixture(scope="session")
def tripod(hexapod: RobotModel) -> MotionPlan:
    """Straight ahead on six limbs, refined as by default."""
    return gf.plan_gait(hexapod, TRIPOD, name="all", options=PATIENT)


@pytest.fixture(scope="session")
def sideways(hexapod: RobotModel) -> MotionPlan:
    return gf.plan_gait(hexapod, TRIPOD, heading=np.pi / 2, samples_per_column=2, options=PATIENT)


@pytest.fixture(scope="session")
def turning(hexapod: RobotModel) -> MotionPlan:
    return gf.plan_gait(hexapod, TRIPOD, speed=0.05, heading=0.3, yaw_rate=0.15, samples_per_column=2, options=PATIENT)


@pytest.fixture(scope="session")
def penta(hexapod: RobotModel) -> MotionPlan:
    """On five limbs, R1 held in a posture of its own."""
    return gf.plan_gait(
        hexapod, PENTA, roles={"R1": gf.Held(TUCKED)}, samples_per_column=4, name="without_R1", options=PATIENT
    )


@pytest.fixture(scope="session")
def change(hexapod: RobotModel, tripod: MotionPlan, penta: MotionPlan) -> MotionPlan:
    return gf.plan_transition(hexapod, tripod, penta, pattern=CHANGE, options=PATIENT)


@pytest.fixture(scope="session")
def start(hexapod: RobotModel, tripod: MotionPlan) -> MotionPlan:
    return gf.plan_start(hexapod, tripod, options=PATIENT)


@pytest.fixture(scope="session")
def stop(hexapod: RobotModel, penta: MotionPlan) -> MotionPlan:
    return gf.plan_stop(hexapod, penta, options=PATIENT)


@pytest.fixture(scope="session")
def wave(quadruped: RobotModel) -> MotionPlan:
    """The quadruped's nominal gait."""
    pattern = gf.synthesize_gait_pattern(quadruped, method="wave", columns=quadruped.nominal.columns)
    return gf.plan_gait(quadruped, pattern, options=PATIENT)


GAITS = ("tripod", "sideways", "turning", "penta", "wave")
OPEN = ("change", "start", "stop")


@pytest.fixture(params=GAITS)
def gait(request: pytest.FixtureRequest) -> MotionPlan:
    plan: MotionPlan = request.getfixturevalue(request.param)
    return plan


@pytest.fixture(params=OPEN)
def open_plan(request: pytest.FixtureRequest) -> MotionPlan:
    plan: MotionPlan = request.getfixturevalue(request.param)
    return plan


@pytest.fixture(params=(*GAITS, *OPEN))
def plan(request: pytest.FixtureRequest) -> MotionPlan:
    plan: MotionPlan = request.getfixturevalue(request.param)
    return plan


@pytest.fixture
def robot_of(hexapod: RobotModel, quadruped: RobotModel):
    """The robot that a plan was made for."""
    return lambda plan: next(r for r in (hexapod, quadruped) if r.limb_names == plan.pattern.limbs)


@pytest.fixture(scope="session")
def lookout(tmp_path_factory: pytest.TempPathFactory) -> RobotModel:
    """The hexapod with a camera on R1, mounted as on the dodecapod."""
    mount = "R1: [{module: camera_mount, tilt: 1.2, pan: 1.3090}, camera]}"
    ahead = "    R1: [-0.2618, 1.3090, -0.1090]\n    R2: [0, 0.7, 0.2]\n    R3: [0, 0.7, 0.2]\n"
    left = "".join(f"    L{k}: [0, 0.7, 0.2]\n" for k in (1, 2, 3))
    held = "  held_posture:                  # rad\n"
    path = write_robot(
        tmp_path_factory.mktemp("lookout"),
        "hexapod",
        ("R1: gripper}", mount),
        (held + "    left: [0, 0.7, 0.2]\n    right: [0, 0.7, 0.2]\n", held + left + ahead),
    )
    return gf.load_robot(path)
