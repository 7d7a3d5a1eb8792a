"""The cascade: candidates in order until one has a plan; what was left stands in the result."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from gaitforge.errors import InfeasibleFootfall, InfeasibleMotion, UnsolvedError
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.footfall.synthesis import gait_pattern_candidates
from gaitforge.motion.plan import Command, MotionPlan
from gaitforge.motion.report import SolveReport
from gaitforge.pipeline.options import Options, Search
from gaitforge.pipeline.schedule import plan_task
from gaitforge.pipeline.search.gaits import plan_phase
from gaitforge.pipeline.search.transitions import plan_change
from gaitforge.pipeline.stopwatch import Stopwatch
from gaitforge.robot.load import load_robot
from gaitforge.robot.model import RobotModel
from gaitforge.task.load import load_task
from gaitforge.task.phase import Phase
from gaitforge.task.scene import Scene, SceneObject

OPTIONS = Options(simulator=None, recorder=None)  # type: ignore[arg-type]  # planning simulates and records nothing


@pytest.fixture(scope="module")
def hexapod() -> RobotModel:
    return load_robot("hexapod")


def plan_of(robot: RobotModel, pattern: FootfallPattern, name: str, duration: float, **more: Any) -> MotionPlan:
    """A plan in which nothing moves: the cascade looks at no trajectory."""
    n = 2 * pattern.columns + 1
    return MotionPlan(
        name, more.get("kind", "gait"), pattern, np.linspace(0.0, duration, n),
        np.zeros((len(robot.joint_names), n)), np.zeros((n, 6)), np.zeros((n, 3)),
        np.zeros((n, len(robot.limbs), 3)), np.zeros((n, 2, len(robot.limbs))), Command(),
    )  # fmt: skip


class Planner:
    """Stands in for the optimiser: refuses as often as it is told, and notes what it was asked."""

    def __init__(self, refusals: list[Exception] | None = None) -> None:
        self.refusals = list(refusals or [])
        self.asked: list[tuple[str, Any]] = []

    def gait(self, robot: RobotModel, pattern: FootfallPattern, *, name: str, duration: float, **more: Any) -> Any:
        self.asked.append((name, (pattern, duration, more)))
        if self.refusals:
            raise self.refusals.pop(0)
        return plan_of(robot, pattern, name, duration)

    def transition(
        self, robot: RobotModel, before: MotionPlan, after: MotionPlan, *, name: str, pattern: Any = None,
        column_s: float = 0.0, **more: Any,
    ) -> Any:  # fmt: skip
        self.asked.append((name, (pattern, column_s, more)))
        if self.refusals:
            raise self.refusals.pop(0)
        return plan_of(robot, pattern or before.pattern, name, 1.0, kind="transition")

    def stand(self, which: str) -> Any:
        return lambda robot, gait, *, name, options: plan_of(robot, gait.pattern, name, 1.0, kind="stand")


@pytest.fixture
def planner(monkeypatch: pytest.MonkeyPatch) -> Planner:
    planner = Planner()
    monkeypatch.setattr("gaitforge.motion.gait.plan_gait", planner.gait)
    monkeypatch.setattr("gaitforge.motion.transition.plan_transition", planner.transition)
    monkeypatch.setattr("gaitforge.motion.stand.plan_start", planner.stand("start"))
    monkeypatch.setattr("gaitforge.motion.stand.plan_stop", planner.stand("stop"))
    return planner


def unsolved(times: int) -> list[Exception]:
    return [UnsolvedError(f"try {i} gave nothing") for i in range(times)]


def test_the_next_candidate_is_taken_when_one_is_unsolved(hexapod: RobotModel, planner: Planner) -> None:
    planner.refusals = unsolved(2)
    segment = plan_phase(hexapod, Phase("walk"), Scene(), OPTIONS, Stopwatch())
    assert [a.why for a in segment.left] == ["try 0 gave nothing", "try 1 gave nothing"]
    patterns = [pattern.contact.tobytes() for _, (pattern, _, _) in planner.asked]
    assert len(patterns) == len(set(patterns)) == 3, "no pattern is tried twice"
    assert segment.plan.pattern.contact.tobytes() == patterns[-1]


@pytest.mark.parametrize(
    ("strains", "tried", "taken"), [((1.3, 0.9, 1.4), 2, 1), ((1.3, 1.1, 1.4, 1.2, 2.0, 2.0), 6, 1)]
)
def test_a_gait_that_no_motors_hold_is_taken_only_when_all_are_like_that(
    planner: Planner, monkeypatch: pytest.MonkeyPatch, strains: tuple[float, ...], tried: int, taken: int
) -> None:
    asked: list[bytes] = []

    def heavy(robot: RobotModel, pattern: FootfallPattern, *, name: str, duration: float, **more: Any) -> MotionPlan:
        plan = plan_of(robot, pattern, name, duration)
        return replace(plan, report=SolveReport(details={"effort_ratio": 1.5}))

    def strain(robot: RobotModel, plan: MotionPlan) -> float:
        asked.append(plan.pattern.contact.tobytes())
        return strains[len(asked) - 1]

    monkeypatch.setattr("gaitforge.motion.gait.plan_gait", heavy)
    monkeypatch.setattr("gaitforge.motion.strain.least_strain", strain)
    monkeypatch.setattr("gaitforge.pipeline.search.batch.spared", lambda one, result: result)  # no plan asks for less
    options = replace(OPTIONS, search=Search(gait_batch=1))
    phase = Phase("walk", gait="program")
    segment = plan_phase(load_robot("dodecapod"), phase, Scene(), options, Stopwatch())
    assert len(asked) == tried
    assert segment.plan.pattern.contact.tobytes() == asked[taken]
    assert sum("of the motors' efforts" in a.why for a in segment.left) == tried - 1


GOOD, WEAK, WEAKER, TIPS = (0.01, 0.5), (0.01, 1.1), (0.01, 1.3), (-0.01, 0.5)
"""(margin [m], strain) of plans"""


@pytest.mark.parametrize(
    ("found", "tried", "taken"),
    [
        ((GOOD,), 1, 0),
        ((TIPS, WEAK, GOOD), 3, 2),
        ((WEAKER, WEAK, TIPS, TIPS, WEAKER, GOOD), 5, 1),
        ((TIPS, (-0.005, 0.5), TIPS, TIPS, TIPS, GOOD), 5, 1),
    ],
)
@pytest.mark.parametrize("least", [0.0, 0.02], ids=["centre of mass", "zero-moment point"])
def test_a_transition_that_tips_or_is_too_heavy_is_taken_only_when_a_few_more_are(
    hexapod: RobotModel, monkeypatch: pytest.MonkeyPatch, found: tuple[tuple[float, float], ...], tried: int,
    taken: int, least: float,
) -> None:  # fmt: skip
    """`least` [m]: by how much the other one of the two margins is larger."""
    rows = {n: "000111" if i % 2 else "111000" for i, n in enumerate(hexapod.limb_names)}
    gait = plan_of(hexapod, FootfallPattern.from_rows(rows), "a", 2.0)
    asked: list[tuple[bytes, float]] = []

    def tipping(
        robot: RobotModel, before: MotionPlan, after: MotionPlan, *, name: str, pattern: FootfallPattern,
        column_s: float, **more: Any,
    ) -> MotionPlan:  # fmt: skip
        plan = plan_of(robot, pattern, name, column_s, kind="transition")
        asked.append((pattern.contact.tobytes(), column_s))
        return replace(
            plan, report=SolveReport(details={"zmp_margin_m": found[len(asked) - 1][0], "effort_ratio": 2.0})
        )

    monkeypatch.setattr("gaitforge.motion.transition.plan_transition", tipping)
    monkeypatch.setattr("gaitforge.pipeline.search.batch.spared", lambda one, result: result)  # no plan asks for less
    monkeypatch.setattr("gaitforge.motion.still.static_margin", lambda robot, plan: found[len(asked) - 1][0] + least)
    monkeypatch.setattr("gaitforge.motion.strain.least_strain", lambda robot, plan: found[len(asked) - 1][1])
    segment = plan_change(hexapod, gait, replace(gait, name="b"), OPTIONS, Stopwatch())
    assert len(asked) == tried
    assert (segment.plan.pattern.contact.tobytes(), segment.plan.duration) == asked[taken]
    tips, weak = "{:.1f} mm outside the feet", "{:.2f} of the motors' efforts"
    assert [a.why for a in segment.left if "the feet" in a.why or "efforts" in a.why] == [
        tips.format(-1e3 * margin) if margin < 0.0 else weak.format(strain)
        for k, (margin, strain) in enumerate(found[:tried])
        if k != taken
    ]


def test_a_search_that_ends_with_nothing_is_unsolved_and_says_what_it_tried(
    hexapod: RobotModel, planner: Planner
) -> None:
    planner.refusals = unsolved(100)
    with pytest.raises(UnsolvedError) as caught:
        plan_phase(hexapod, Phase("walk"), Scene(), OPTIONS, Stopwatch())
    tried = caught.value.explain["tried"]
    assert [t["why"] for t in tried] == [f"try {i} gave nothing" for i in range(len(tried))]
    assert len(tried) >= 3
    assert len(planner.asked) == len(tried) + 1, "the first is asked once more, for why"
    assert planner.asked[-1][1][0] is planner.asked[0][1][0]


def test_certificates_against_some_patterns_are_no_proof_against_all(hexapod: RobotModel, planner: Planner) -> None:
    planner.refusals = [InfeasibleMotion("this pattern cannot", {}) for _ in range(100)]
    with pytest.raises(UnsolvedError):
        plan_phase(hexapod, Phase("walk"), Scene(), OPTIONS, Stopwatch())


def test_a_certificate_against_the_one_pattern_asked_for_is_the_answer(hexapod: RobotModel, planner: Planner) -> None:
    planner.refusals = [InfeasibleMotion("this pattern cannot", {})]
    with pytest.raises(InfeasibleMotion, match="this pattern cannot"):
        plan_phase(hexapod, Phase("walk", gait="tripod"), Scene(), OPTIONS, Stopwatch())


def test_a_hand_written_pattern_is_planned_as_it_is(hexapod: RobotModel, planner: Planner) -> None:
    rows = {n: "000111" if i % 2 else "111000" for i, n in enumerate(reversed(hexapod.limb_names))}
    segment = plan_phase(hexapod, Phase("walk", gait=rows), Scene(), OPTIONS, Stopwatch())
    pattern = segment.plan.pattern
    assert pattern.limbs == hexapod.limb_names
    assert {n: "".join(str(int(c)) for c in pattern.row(n)) for n in pattern.limbs} == rows
    assert pattern.source == "given"


def test_too_few_locomotive_limbs_are_infeasible_before_anything_is_planned(
    hexapod: RobotModel, planner: Planner
) -> None:
    task = load_task({"phases": [{"name": "a", "roles": dict.fromkeys(("L1", "L2", "R1"), "held")}]}, "t")
    with pytest.raises(InfeasibleFootfall) as caught:
        plan_phase(hexapod, task.phases[0], Scene(), OPTIONS, Stopwatch())
    assert {"g5", "g8"} <= set(caught.value.explain["families"])
    assert planner.asked == []


def test_a_named_point_of_the_scene_reaches_the_planner_in_metres(planner: Planner) -> None:
    robot = load_robot("dodecapod")
    scene = Scene((SceneObject("pipe", "pipe", (2.5, 0.1, 0.3)),))
    data = {"phases": [{"name": "a", "roles": {"camera": {"role": "tool", "look_at": "pipe.opening"}}}]}
    with_pipe = {**data, "scene": [{"name": "pipe", "kind": "pipe", "pose": {"xyz": [2.5, 0.1, 0.3]}}]}
    task = load_task(with_pipe, "t", robot=robot)
    plan_phase(robot, task.phases[0], scene, OPTIONS, Stopwatch())
    roles = planner.asked[0][1][2]["roles"]
    carrier = next(t.limb for t in robot.tools if t.name == "camera")
    assert roles[carrier].look_at == (2.5, 0.1, 0.3)
    assert set(roles) == {carrier}


def test_a_wave_keeps_the_time_of_a_column(hexapod: RobotModel, planner: Planner) -> None:
    plan_phase(hexapod, Phase("walk", gait="wave"), Scene(), OPTIONS, Stopwatch())
    pattern, duration, _ = planner.asked[0][1]
    nominal = hexapod.nominal
    assert pattern.columns > nominal.columns
    assert duration / pattern.columns == pytest.approx(nominal.duration / nominal.columns)
    plan_phase(hexapod, Phase("walk", gait="wave", duration=5.0), Scene(), OPTIONS, Stopwatch())
    assert planner.asked[1][1][1] == 5.0


def names(task: dict[str, Any], robot: RobotModel) -> list[tuple[str, int]]:
    done: list[Any] = []
    plan_task(robot, load_task(task, "t", robot=robot), OPTIONS, Stopwatch(), done)
    return [(s.plan.name, s.cycles) for s in done]


def test_phases_become_stand_gait_transition_gait_stand(hexapod: RobotModel, planner: Planner) -> None:
    task = {"phases": [{"name": "a", "cycles": 2}, {"name": "b", "cycles": 3, "roles": {"R1": "held"}}]}
    assert names(task, hexapod) == [("start", 1), ("a", 2), ("a_to_b", 1), ("b", 3), ("stop", 1)]


def test_a_phase_that_asks_for_the_same_gait_goes_on_with_it(hexapod: RobotModel, planner: Planner) -> None:
    task = {"phases": [{"name": "a", "cycles": 2}, {"name": "b", "cycles": 3}]}
    assert names(task, hexapod) == [("start", 1), ("a", 5), ("stop", 1)]


def test_a_gait_that_comes_back_is_not_planned_again(hexapod: RobotModel, planner: Planner) -> None:
    task = {"phases": [{"name": "a"}, {"name": "b", "speed": 0.05}, {"name": "c"}]}
    assert [n for n, _ in names(task, hexapod)] == ["start", "a", "a_to_b", "b", "b_to_c", "c", "stop"]
    assert [n for n, _ in planner.asked] == ["a", "b", "a_to_b", "b_to_c"]


def test_a_transition_tries_every_timing_before_the_second_pattern(hexapod: RobotModel, planner: Planner) -> None:
    search = Search(transition_columns=(0, 1), transition_stretch=(1.0, 1.5), transition_candidates=2)
    task = {"phases": [{"name": "a"}, {"name": "b", "roles": {"R1": "held"}}]}
    done: list[Any] = []
    original = planner.gait

    def gaits_succeed(*args: Any, **more: Any) -> Any:
        kept, planner.refusals = planner.refusals, []
        try:
            return original(*args, **more)
        finally:
            planner.refusals = kept

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("gaitforge.motion.gait.plan_gait", gaits_succeed)
        planner.refusals = unsolved(4)
        options = Options(simulator=None, recorder=None, search=search)  # type: ignore[arg-type]
        plan_task(hexapod, load_task(task, "t", robot=hexapod), options, Stopwatch(), done)
    tries = [(p.columns, round(s, 4)) for name, (p, s, _) in planner.asked if name == "a_to_b"]
    m, dt = hexapod.nominal.transition_columns, hexapod.nominal.transition_column_s
    first_round = [(m, dt), (m + 1, dt), (m, 1.5 * dt), (m + 1, 1.5 * dt)]
    assert tries[:4] == [(c, round(s, 4)) for c, s in first_round]
    assert tries[4] == tries[0]
    assert len(done[2].left) == 4


def test_equation_three_needs_no_pattern(hexapod: RobotModel, planner: Planner) -> None:
    task = load_task({"phases": [{"name": "a"}, {"name": "b", "roles": {"R1": "held"}}]}, "t", robot=hexapod)
    options = Options(simulator=None, recorder=None, transition="interpolate")  # type: ignore[arg-type]
    plan_task(hexapod, task, options, Stopwatch(), [])
    ((pattern, _, more),) = [asked for name, asked in planner.asked if name == "a_to_b"]
    assert pattern is None
    assert more["method"] == "interpolate"


def test_seconds_are_booked_on_the_stage_that_spent_them() -> None:
    watch = Stopwatch()
    with watch.stage("motion"), watch.stage("verify"):
        pass
    with pytest.raises(ZeroDivisionError), watch.stage("record"):
        _ = 1 / 0
    timings = watch.timings()
    assert timings["motion"] >= timings["verify"] > 0.0
    assert timings["record"] > 0.0
    assert timings["footfall"] == 0.0
    assert timings["total"] >= timings["motion"]


def test_the_cheapest_of_a_batch_is_kept_and_what_was_left_is_recorded(
    hexapod: RobotModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    costs = iter([3.0, 2.0, 1.0])

    def planned(robot: RobotModel, pattern: FootfallPattern, *, name: str, duration: float, **_: Any) -> MotionPlan:
        plan = plan_of(robot, pattern, name, duration)
        return replace(plan, report=SolveReport(cost=next(costs)))

    monkeypatch.setattr("gaitforge.motion.gait.plan_gait", planned)
    task = load_task({"phases": [{"name": "a", "roles": {"L1": "held"}}]}, "t", robot=hexapod)
    segment = plan_phase(hexapod, task.phases[0], Scene(), OPTIONS, Stopwatch())
    assert segment.plan.report.cost == 2.0, "the third is not tried: the first batch has a plan"
    assert segment.left[-1].why == "cost 3, another has 2"
    reasons = [a.why for a in segment.left]
    assert "breaks g8" in reasons, "candidates that the families do not allow"


def test_a_stable_gait_goes_on_without_its_lost_limb_and_nothing_else_is_tried(planner: Planner) -> None:
    robot = load_robot("dodecapod")
    task = load_task({"phases": [{"name": "a", "roles": {"L4": "held"}}]}, "t", robot=robot)
    segment = plan_phase(robot, task.phases[0], Scene(), OPTIONS, Stopwatch())
    assert len(planner.asked) == 1
    assert segment.plan.pattern.info["operation"] == "original"


def test_the_gait_before_is_handed_on_to_the_next_phase(
    hexapod: RobotModel, planner: Planner, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []
    original = gait_pattern_candidates

    def noted(*args: Any, **more: Any) -> Any:
        asked.append(more["original"])
        return original(*args, **more)

    monkeypatch.setattr("gaitforge.footfall.synthesis.gait_pattern_candidates", noted)
    task = {"phases": [{"name": "a"}, {"name": "b", "roles": {"R1": "held"}}]}
    names(task, hexapod)
    assert asked[0] is None
    assert asked[1] is not None
    assert asked[1].locomotive == hexapod.limb_names


@pytest.mark.parametrize(
    "wrong",
    [
        {"workers": 0},
        {"gait_batch": 0},
        {"transition_batch": 0},
        {"transition_slack": -1},
        {"transition_phases": "worst"},
    ],
)
def test_a_search_that_makes_no_sense_is_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(ValueError):
        Search(**wrong)
