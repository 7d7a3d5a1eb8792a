"""Footfall problems of a robot: its limbs and sides, nominal footholds and centre of mass."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitforge.errors import InputError, Problem
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.footfall.problem import FootfallProblem

if TYPE_CHECKING:
    from gaitforge.robot.model import RobotModel


def limbs_named(robot: RobotModel, names: Iterable[str] | None) -> tuple[str, ...]:
    """Limb names in the order of the rows; None means all.  A name may be that of a tool; InputError for others."""
    if names is None:
        return robot.limb_names
    wanted: set[str] = set()
    problems: list[Problem] = []
    for name in names:
        try:
            wanted.add(robot.limb(name).name)
        except InputError as error:
            problems += error.problems
    if problems:
        raise InputError(problems)
    return tuple(n for n in robot.limb_names if n in wanted)


def gait_problem(robot: RobotModel, locomotive: Iterable[str] | None, columns: int) -> FootfallProblem:
    """The cyclic problem for the limbs that walk."""
    walking = limbs_named(robot, locomotive)
    return FootfallProblem(
        limbs=robot.limb_names,
        sides=tuple(limb.side for limb in robot.limbs),
        columns=columns,
        cyclic=True,
        locomotive_before=walking,
        locomotive_after=walking,
        **_stance_geometry(robot, walking),
    )


def transition_problem(
    robot: RobotModel,
    before: Any,
    after: Any,
    columns: int,
    from_column: int | None = None,
    to_column: int | None = None,
) -> FootfallProblem:
    """The problem between two patterns (or plans that have a `.pattern`).

    The first column is what the pattern before would do next, `from_column` (default: its column 0), the
    last what the pattern after would have done just before, `to_column` (default: its last column).  A
    pattern that is not cyclic does nothing next: its nearest column is taken.
    """
    old, new = pattern_of(robot, before, "before"), pattern_of(robot, after, "after")
    leave = (0 if old.cyclic else old.columns - 1) if from_column is None else from_column
    enter = (new.columns - 1 if new.cyclic else 0) if to_column is None else to_column
    for key, column, pattern in (("from_column", leave, old), ("to_column", enter, new)):
        if not -pattern.columns <= column < pattern.columns:
            raise InputError(Problem("footfall", key, repr(column), f"a column, 0 … {pattern.columns - 1}"))
    walking = tuple(n for n in robot.limb_names if n in {*old.locomotive, *new.locomotive})
    return FootfallProblem(
        limbs=robot.limb_names,
        sides=tuple(limb.side for limb in robot.limbs),
        columns=columns,
        cyclic=False,
        locomotive_before=old.locomotive,
        locomotive_after=new.locomotive,
        first=old.contact[:, leave],
        last=new.contact[:, enter],
        parameters={"from_column": leave % old.columns, "to_column": enter % new.columns},
        **_stance_geometry(robot, walking),
    )


def pattern_of(robot: RobotModel, source: Any, key: str) -> FootfallPattern:
    """The pattern itself, or the one that a plan carries; InputError unless its rows are the robot's limbs."""
    pattern = source if isinstance(source, FootfallPattern) else getattr(source, "pattern", None)
    if not isinstance(pattern, FootfallPattern):
        raise InputError(Problem("footfall", key, type(source).__name__, "a FootfallPattern, or a plan with a pattern"))
    if pattern.limbs != robot.limb_names:
        expected = "rows " + ", ".join(robot.limb_names)
        raise InputError(Problem("footfall", key, "rows " + ", ".join(pattern.limbs), expected))
    return pattern


def _stance_geometry(robot: RobotModel, walking: tuple[str, ...]) -> dict[str, Any]:
    """Footholds (n_F, 2) and centre of mass (2,) [m] of the nominal stance, limbs that do not walk held."""
    joints = robot.standing_on(walking)
    base = np.array([0.0, 0.0, robot.nominal.body_height, 0.0, 0.0, 0.0])
    return {
        "footholds": robot.foot_positions(base, joints)[:, :2],
        "center_of_mass": robot.center_of_mass(base, joints)[:2],
    }
