"""PyBullet as a simulator: a DIRECT client, a world, and a loop that records what happens.

Nothing here judges; see `gaitforge.verify.assemble` and `gaitforge.verify.checks`.
"""

from gaitforge.verify.pybullet.simulator import PyBulletSimulator

__all__ = ["PyBulletSimulator"]
