"""Two simulators asked about the same timeline."""

from __future__ import annotations

from dataclasses import dataclass, field

from gaitforge.verify.mujoco import MujocoSimulator
from gaitforge.verify.pybullet import PyBulletSimulator
from gaitforge.verify.simulator import Simulator


@dataclass(frozen=True)
class Both:
    """PyBullet and MuJoCo, one after the other: a run is verified when it is so in both.

    The verdict holds the checks of both and PyBullet's trace; where they disagree is told, never averaged.
    """

    pybullet: PyBulletSimulator = field(default_factory=PyBulletSimulator)
    mujoco: MujocoSimulator = field(default_factory=MujocoSimulator)
    name: str = "pybullet and mujoco"

    @property
    def simulators(self) -> tuple[Simulator, ...]:
        """In the order in which they are asked; the first one's trace is kept."""
        return self.pybullet, self.mujoco
