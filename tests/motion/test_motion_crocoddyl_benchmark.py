"""What gaitforge asks Crocoddyl for, and the page that tells the answer; Crocoddyl itself is not needed."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pinocchio
import pytest

import gaitforge as gf
from benchmarks.motion_crocoddyl import Own, page, request

REPLY = {
    "versions": {"crocoddyl": "3.2.1"},
    "plans": [
        {
            "nodes": 96, "dt": 0.02, "iterations": 500, "solved": False, "build_s": [0.01, 0.02, 0.09],
            "processor_s": [0.3, 0.2, 9.0], "wall_s": [0.4, 0.4, 0.4], "slip_m": 0.0012, "penetration_m": 0.0,
            "landing_error_m": 0.002, "lift_m": 0.025, "cone_excess_N": -0.5, "cyclic_gap_rad": 0.03, "torque_Nm": 4.8,
        }
    ],
}  # fmt: skip


@pytest.fixture(scope="module")
def robot() -> gf.RobotModel:
    return gf.load_robot("quadruped")


@pytest.fixture(scope="module")
def plan(robot: gf.RobotModel) -> gf.MotionPlan:
    return gf.plan_gait(robot, gf.synthesize_gait_pattern(robot, method="wave"))


def test_the_request_puts_pinocchios_feet_where_the_plan_has_them(robot, plan, tmp_path: Path) -> None:
    urdf = tmp_path / "robot.urdf"
    urdf.write_text(robot.urdf, encoding="utf-8")
    asked = json.loads(json.dumps(request(robot, plan, urdf, repeats=3)))
    model = pinocchio.buildModelFromUrdf(asked["urdf"], pinocchio.JointModelFreeFlyer())
    data = model.createData()
    for key, tolerance in (("start", 1e-6), ("soon", 1e-3)):
        q = pinocchio.neutral(model)
        base = np.array(asked[key]["base"])
        q[:7] = pinocchio.SE3ToXYZQUAT(pinocchio.SE3(pinocchio.rpy.rpyToMatrix(base[3:]), base[:3]))
        for name, angle in asked[key]["joints"].items():
            q[model.joints[model.getJointId(name)].idx_q] = angle
        pinocchio.framesForwardKinematics(model, data, q)
        for foot, planned in zip(asked["feet"], plan.feet[0], strict=True):
            frame = model.getFrameId(foot["link"], pinocchio.FrameType.BODY)
            assert data.oMf[frame].act(np.array(foot["offset"])) == pytest.approx(planned, abs=tolerance), key
    assert np.array_equal(np.array(asked["contact"], dtype=bool), plan.pattern.contact)
    assert asked["speed"] * asked["duration"] == pytest.approx(robot.nominal.speed * plan.duration, rel=1e-6)


def test_the_page_tells_medians_the_ratio_and_who_did_not_converge(robot, plan) -> None:
    asked = request(robot, plan, Path("solo12.urdf"), repeats=3)
    text = page(asked, Own(plan, (0.1, 0.05, 0.9), (0.2, 0.2, 0.2)), REPLY)
    row = next(line for line in text.splitlines() if line.startswith("| Crocoddyl |"))
    cells = [cell.strip() for cell in row.strip("|").split("|")]
    assert cells == [
        "Crocoddyl", "96 nodes of 20 ms", "**300** (+ 20)", "400", "3.0", "500, not converged", "1.2", "0.0", "2.0",
        "0.030",
    ]  # fmt: skip
    assert "friction cones by 0.00 N at most" in text
    assert "crocoddyl 3.2.1" in text
