"""Which simulator judges where none is named."""

from __future__ import annotations

from gaitforge.verify.mujoco import MujocoSimulator
from gaitforge.verify.pybullet import PyBulletSimulator
from gaitforge.verify.pybullet.client import has_pybullet
from gaitforge.verify.simulator import Simulator


def default_simulator() -> Simulator:
    """PyBullet, or MuJoCo where PyBullet is not installed."""
    return PyBulletSimulator() if has_pybullet() else MujocoSimulator()
