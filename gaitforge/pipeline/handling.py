"""Tasks that pick up and put down: what is carried while the robot walks, and the stands before and after."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gaitforge.errors import UnsolvedError
from gaitforge.motion.plan import MotionPlan
from gaitforge.pipeline.options import Options
from gaitforge.pipeline.search.refusals import first_allowed
from gaitforge.pipeline.search.segment import Segment
from gaitforge.pipeline.stopwatch import Stopwatch
from gaitforge.robot.model import RobotModel
from gaitforge.task.handling import GROUND, Pick, Place
from gaitforge.task.phase import Phase, Task
from gaitforge.task.roles import Carry, Role
from gaitforge.task.scene import Scene, SceneObject

if TYPE_CHECKING:
    from gaitforge.motion.manipulation.pick_place import Carried


EDGE_M = 0.02
"""[m] that the middle of a load is to be inside the edge of what it is put on, at least"""


@dataclass(frozen=True, eq=False)
class Carriage:
    """The robot as it walks with what it has picked up, and the task without picking up and putting down."""

    robot: RobotModel
    """Its held posture is that of the grasps, its standing posture one that the loads let it keep"""
    walk: Task
    carried: tuple[Carried, ...]
    places: tuple[Place, ...]

    def steadied(self, options: Options) -> Options:
        """What the walk is planned with: with a load the body goes steadily and the feet go higher."""
        if not self.carried:
            return options
        from gaitforge.motion.manipulation.steady import steadied
        from gaitforge.motion.options import MotionOptions

        return replace(options, motion=steadied(options.motion or MotionOptions(), self.robot))

    def around(
        self, bare: RobotModel, scene: Scene, walking: list[Segment], options: Options, watch: Stopwatch,
        earlier: Sequence[Segment] = (),
    ) -> list[Segment]:  # fmt: skip
        """The stands of picking up, the walk itself, the stands of putting down; `bare` is the robot without loads.

        `earlier`: what is executed before; limbs that held then are put down, and those that hold now lifted.
        """
        if not self.carried:
            return walking
        holdings = tuple(c.holding() for c in self.carried)
        laden = [replace(s, plan=replace(s.plan, holdings=holdings)) for s in walking]
        with watch.stage("motion"):
            before = [Segment(p) for p in self._picks(bare, laden[0].plan)]
            after = [Segment(p) for p in self._places(bare, scene, laden[-1].plan)]
        for segment in (*before, *after):
            margin = 1000.0 * float(segment.plan.report.details["margin_m"])
            watch.progress("motion", f"{segment.plan.name}: {segment.plan.duration:.2f} s, margin {margin:.0f} mm")
        between = self._regrouped(bare, earlier[-1].plan, before[0].plan, options, watch) if earlier else []
        segments = [*between, *before, *laden, *after]
        self._refuse_overhang(scene, [*earlier, *segments])
        return segments

    @staticmethod
    def _regrouped(
        robot: RobotModel, stood: MotionPlan, ready: MotionPlan, options: Options, watch: Stopwatch
    ) -> list[Segment]:
        """The first way that simulation has not refused; the first of all where it has refused every one."""
        from gaitforge.motion.manipulation.regroup import regroup_plans
        from gaitforge.motion.options import MotionOptions

        with watch.stage("motion"):
            plan = first_allowed(regroup_plans(robot, stood, ready, MotionOptions()), options.refused)
        watch.progress("motion", f"{plan.name}: {plan.duration:.2f} s, {plan.report.seconds:.2f} s to solve")
        return [Segment(plan)]

    def _refuse_overhang(self, scene: Scene, segments: Sequence[Segment]) -> None:
        """What is put on a box has its centre of mass over that box, where the planned walk leads."""
        from gaitforge.motion.manipulation.putting import inside_top
        from gaitforge.motion.timeline_build import laid_out

        entries = {entry.plan.name: entry for entry in laid_out([(s.plan, s.cycles) for s in segments])}
        for place in self.places:
            if place.onto == GROUND:
                continue
            name = f"{place.object}_open"
            margin = inside_top(entries[name], place.object, _box(scene, place.onto))
            if margin < EDGE_M:
                where = (
                    f"{abs(1000 * margin):.0f} mm {'inside' if margin >= 0.0 else 'beyond'} the edge of {place.onto}"
                )
                raise UnsolvedError(
                    f"{name}: the middle of {place.object} comes to be {where}",
                    {"segment": name, "families": ["scene"], "value": margin, "unit": "m",
                     "advice": f"another place or size of {place.onto}, or more or fewer cycles"},
                )  # fmt: skip

    def _picks(self, robot: RobotModel, start: MotionPlan) -> list[MotionPlan]:
        """Backwards from the rest in which the walk begins: what is picked up last is fixed first."""
        from gaitforge.motion.manipulation.pick_place import plan_pick, rest_of

        plans: list[MotionPlan] = []
        end, roles = rest_of(start, first=True), dict(start.roles)
        for index in reversed(range(len(self.carried))):
            own, others = self.carried[index], self.carried[:index]
            new = plan_pick(robot, own, end, _without(roles, own), [c.holding() for c in others])
            plans = [*new, *plans]
            end = rest_of(plans[0], first=True)
        return plans

    def _places(self, robot: RobotModel, scene: Scene, stop: MotionPlan) -> list[MotionPlan]:
        from gaitforge.motion.manipulation.pick_place import plan_place, rest_of

        plans: list[MotionPlan] = []
        start, held = rest_of(stop, first=False), {c.box.name: c for c in self.carried}
        for place in self.places:
            own = held.pop(place.object)
            others = [c.holding() for c in held.values()]
            plans += plan_place(robot, own, start, _without(stop.roles, own), surface_of(place, scene), others)
            start = rest_of(plans[-1], first=False)
        return plans


def blocks(task: Task) -> list[Task]:
    """Parts of a task, each of which picks up, walks and puts down; what is picked up after a walk begins the next."""
    parts: list[list[Phase]] = [[]]
    for phase in task.phases:
        if phase.kind == "pick" and any(p.kind != "pick" for p in parts[-1]):
            parts.append([])
        parts[-1].append(phase)
    return [replace(task, phases=tuple(part)) for part in parts]


def carriage(robot: RobotModel, task: Task, place: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Carriage:
    """What the picks at the beginning of a task lead to; a task without any is walked as it is.

    `place`: x, y [m] and yaw [rad] of the base where it picks up.

    Raises `InfeasibleMotion` when a limb does not reach what it is to pick up.
    """
    picks = [p.handling for p in task.phases if isinstance(p.handling, Pick)]
    places = tuple(p.handling for p in task.phases if isinstance(p.handling, Place))
    phases = tuple(p for p in task.phases if p.kind == "walk")
    if not picks:
        return Carriage(robot, replace(task, phases=phases), (), ())
    from gaitforge.motion.manipulation.footing import under_load
    from gaitforge.motion.manipulation.pick_place import carry

    carried = tuple(carry(robot, _box(task.scene, pick.object), pick, place) for pick in picks)
    postures = {name: joints for c in carried for name, joints in c.joints.items()}
    held = np.array(robot.nominal.held_posture, dtype=float)
    for name, joints in postures.items():
        held[robot.joint_indices(robot.limb(name))] = joints
    grasping = replace(robot, nominal=replace(robot.nominal, held_posture=held))
    walking = [name for name in robot.limb_names if name not in postures]
    stance = under_load(grasping.carrying(*(c.load for c in carried)), walking).nominal
    laden = tuple(_laden(phase, carried) for phase in phases)
    return Carriage(replace(grasping, nominal=stance), replace(task, phases=laden), carried, places)


def surface_of(place: Place, scene: Scene) -> float:
    """[m] height of what a load is put on."""
    if place.onto == GROUND:
        return 0.0
    stand = _box(scene, place.onto)
    return stand.xyz[2] + 0.5 * stand.size[2]


def _box(scene: Scene, name: str) -> SceneObject:
    return next(item for item in scene.objects if item.name == name)


def _laden(phase: Phase, carried: Sequence[Carried]) -> Phase:
    roles = {name: role for c in carried for name, role in c.roles.items()}
    return replace(phase, roles={**phase.roles, **roles}, loads=(*phase.loads, *(c.load for c in carried)))


def _without(roles: Mapping[str, Role], own: Carried) -> dict[str, Role]:
    return {n: r for n, r in roles.items() if not (isinstance(r, Carry) and r.object == own.box.name)}
