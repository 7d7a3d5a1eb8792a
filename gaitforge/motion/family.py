"""What constraint and cost families of the motion problem have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, ClassVar

from gaitforge.motion.problem import Problem
from gaitforge.motion.trajectory import Trajectory


class Family(ABC):
    """One sentence about a motion, said at every instant where it holds.

    A subclass writes one instant as a kernel and names the places; the problem maps and adds up.
    """

    name: ClassVar[str]
    unit: ClassVar[str]
    enforced: ClassVar[str] = "at samples"
    """Where the family holds, and so where it does not."""

    @abstractmethod
    def add_to(self, problem: Problem, trajectory: Trajectory) -> None:
        """Add the family's rows (or costs) for every place."""


def carried(vector: Any, frame: Any) -> Any:
    """A point (3,) given in the frame of the next sample, in the frame of this one; `frame` is x, y, yaw."""
    import casadi as ca

    c, s = ca.cos(frame[2]), ca.sin(frame[2])
    return ca.vertcat(c * vector[0] - s * vector[1] + frame[0], s * vector[0] + c * vector[1] + frame[1], vector[2])


def carried_back(vector: Any, frame: Any) -> Any:
    """A point (3,) given in the frame of the sample before, in the frame of this one."""
    import casadi as ca

    c, s = ca.cos(frame[2]), ca.sin(frame[2])
    x, y = vector[0] - frame[0], vector[1] - frame[1]
    return ca.vertcat(c * x + s * y, -s * x + c * y, vector[2])
