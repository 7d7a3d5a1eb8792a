"""Limbs are lost while the robot walks: the next gait and the way into it, as fast as they can be had."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from gaitforge.errors import InfeasibleFootfall, InputError, Problem, UnsolvedError
from gaitforge.footfall.from_robot import limbs_named
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.rotate import rotated
from gaitforge.pipeline.search.segment import Attempt, exhausted
from gaitforge.pipeline.search.tries import Try, attempt, cheapest, unexplained, why
from gaitforge.robot.model import RobotModel
from gaitforge.task.roles import Failed, Held, Role

Policy = Literal["first", "best"]
POLICIES: tuple[Policy, ...] = ("first", "best")
CANDIDATES = 6
"""[patterns] of a gait or a transition that are planned at most, for each timing"""
STRETCHES = (1.0, 1.333)
"""Factors on the nominal time of a transition's column"""


@dataclass(frozen=True, eq=False)
class Recovery:
    """Two checked plans, to be executed one after the other when the gait before reaches the end of its cycle."""

    transition: MotionPlan
    gait: MotionPlan
    left: tuple[Attempt, ...]
    """What was tried and left, and why."""
    seconds: Mapping[str, float]
    """[s] by stage: gait_pattern, gait, transition_pattern, transition, total"""


def recover(
    robot: RobotModel,
    gait: MotionPlan,
    lost: Iterable[str],
    *,
    leave: int = 0,
    roles: Mapping[str, Role] | None = None,
    policy: Policy = "first",
    speed: float | None = None,
    footfall: Mapping[str, Any] | None = None,
    options: MotionOptions | None = None,
) -> Recovery:
    """From the running `gait` and the limbs that walk no more to the next gait and the transition into it.

    `leave`: the column of the gait's cycle at which it is left (the transition is planned for a gait begun
    there, `rotated`).  `roles`: what lost limbs do, by default they are `Held`: the transition lifts them (one that
    is locked cannot be, see ``task=limb_failure``).  `policy`: *first* takes the first pattern that has a plan, the
    running gait without the limbs if it will do; *best* plans the patterns of the cascade and takes the cheapest.
    `speed` [m/s], None: that of `gait`; `footfall`: keyword arguments of the pattern synthesis.
    Both plans are checked densely, as `plan_gait` and `plan_transition` do.  Raises InputError for limbs that do not
    exist or do not walk, `InfeasibleFootfall` with a proof, `UnsolvedError` when no pattern had a plan.
    """
    if policy not in POLICIES:
        raise InputError(Problem("recover", "policy", repr(policy), "one of " + ", ".join(POLICIES)))
    search = _Search(robot, rotated(gait, leave), _gone(robot, gait, lost), policy, dict(footfall or {}), options)
    begin = time.perf_counter()
    given = {robot.limb(name).name: role for name, role in (roles or {}).items()}
    locked = [name for name in search.lost if isinstance(given.get(name), Failed)]
    if locked:
        found, expected = ", ".join(locked) + " failed", "limbs that can be lifted; task=limb_failure for others"
        raise InputError(Problem("recover", "roles", found, expected))
    after = search.gait({**gait.roles, **{name: Held() for name in search.lost}, **given}, speed)
    move = search.transition(after)
    return Recovery(move, after, tuple(search.left), {**search.seconds, "total": time.perf_counter() - begin})


def _gone(robot: RobotModel, gait: MotionPlan, lost: Iterable[str]) -> tuple[str, ...]:
    gone, walking = limbs_named(robot, lost), gait.pattern.locomotive
    idle = [name for name in gone if name not in walking]
    if idle or not gone:
        found = ", ".join(idle) or "none"
        raise InputError(Problem("recover", "lost", found, "limbs that walk in the gait: " + ", ".join(walking)))
    return gone


class _Search:
    """One recovery: tries in order of promise, and where the time goes."""

    def __init__(
        self, robot: RobotModel, before: MotionPlan, lost: tuple[str, ...], policy: Policy, footfall: dict[str, Any],
        options: MotionOptions | None,
    ) -> None:  # fmt: skip
        self.robot, self.before, self.lost, self.policy = robot, before, lost, policy
        self.footfall = footfall
        self.options = unexplained(options)
        self.left: list[Attempt] = []
        self.seconds: dict[str, float] = {}

    def gait(self, roles: Mapping[str, Role], speed: float | None) -> MotionPlan:
        """A plan on the limbs that are left."""
        before, command = self.before, self.before.command
        column_s = before.duration / before.pattern.columns
        tries = (
            Try(f"{p.source} pattern, {p.columns} columns", "gait", self.robot, (p,), {
                "speed": command.speed if speed is None else speed, "heading": command.heading,
                "yaw_rate": command.yaw_rate, "duration": column_s * p.columns, "roles": roles,
                "loads": before.loads, "name": "without_" + "_".join(self.lost), "options": self.options,
            })
            for p in self._timed("gait_pattern", self._gait_patterns())
        )  # fmt: skip
        return self._planned("gait", tries)

    def transition(self, after: MotionPlan) -> MotionPlan:
        """A plan from the gait before into the gait after."""
        nominal = self.robot.nominal
        tries = (
            Try(f"{p.columns} columns of {seconds:.3f} s", "transition", self.robot, (self.before, after), {
                "pattern": p, "column_s": seconds, "name": f"{self.before.name}_to_{after.name}",
                "options": self.options,
            })
            for stretch in STRETCHES
            for seconds in [nominal.transition_column_s * stretch]
            for p in self._timed("transition_pattern", self._transition_patterns(after))
        )  # fmt: skip
        return self._planned("transition", tries)

    def _planned(self, kind: str, tries: Iterator[Try]) -> MotionPlan:
        """The first try with a plan, or the cheapest of `CANDIDATES` with one."""
        size, first = 1 if self.policy == "first" else CANDIDATES, None
        while batch := _taken(tries, size):
            first = first or batch[0]
            begin = time.perf_counter()
            plan, left = cheapest([attempt(one) for one in batch])
            self.seconds[kind] = self.seconds.get(kind, 0.0) + time.perf_counter() - begin
            self.left += left
            if plan is not None:
                return plan
        explain = exhausted(kind, self.left, why(first))
        raise UnsolvedError(f"{kind} without {', '.join(self.lost)}: no try has a plan", explain)

    def _gait_patterns(self) -> Iterator[FootfallPattern]:
        from gaitforge.footfall.quick import pattern_without
        from gaitforge.footfall.synthesis import gait_pattern_candidates

        original = self.before.pattern
        constraints = self.footfall.get("constraints")
        quick = pattern_without(self.robot, original, self.lost, constraints=constraints)
        if quick is not None and self.policy == "first":
            yield quick
        left = [name for name in original.locomotive if name not in self.lost]
        for pattern in gait_pattern_candidates(
            self.robot, locomotive=left, columns=original.columns, limit=CANDIDATES, original=original, **self.footfall
        ):
            if quick is None or self.policy != "first" or pattern.contact.tobytes() != quick.contact.tobytes():
                yield pattern

    def _transition_patterns(self, after: MotionPlan) -> Iterator[FootfallPattern]:
        from gaitforge.footfall.quick import quick_transition_pattern
        from gaitforge.footfall.synthesis import transition_pattern_candidates

        between = (self.robot, self.before.pattern, after.pattern)
        columns = self.robot.nominal.transition_columns
        if self.policy == "first":
            yield quick_transition_pattern(*between, columns=columns, **self.footfall)
        for m in (columns, columns + 1, columns - 1):
            try:
                yield from transition_pattern_candidates(*between, columns=m, limit=CANDIDATES, **self.footfall)
            except InfeasibleFootfall as error:
                self.left.append(Attempt(f"pattern of {m} columns", str(error), 0.0))

    def _timed(self, stage: str, patterns: Iterator[FootfallPattern]) -> Iterator[FootfallPattern]:
        while True:
            begin = time.perf_counter()
            pattern = next(patterns, None)
            self.seconds[stage] = self.seconds.get(stage, 0.0) + time.perf_counter() - begin
            if pattern is None:
                return
            yield pattern


def _taken(tries: Iterator[Try], size: int) -> Sequence[Try]:
    taken: list[Try] = []
    while len(taken) < size and (one := next(tries, None)) is not None:
        taken.append(one)
    return taken
