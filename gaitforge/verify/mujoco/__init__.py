"""MuJoCo as a simulator: a model made of the URDF, joint servos, and a loop that records what happens.

Nothing here judges; see `gaitforge.verify.assemble` and `gaitforge.verify.checks`.
"""

from gaitforge.verify.mujoco.simulator import MujocoSimulator

__all__ = ["MujocoSimulator"]
