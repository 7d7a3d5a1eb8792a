"""Two tolerances of the ground: the tighter one is tried first, and only what it is to blame for is tried again."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import gaitforge.motion.refine as refine
from gaitforge.errors import UnsolvedError
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import MotionPlan
from gaitforge.motion.report import SolveReport

OPTIONS = MotionOptions()
WALKING = SimpleNamespace(base_velocity=np.array([0.06, 0.0, 0.0, 0.0, 0.0, 0.0]))


def segment(feet: int) -> Any:
    """A transition between gaits that ever stands on so many feet."""
    contact = np.ones((3, 6), dtype=bool)
    contact[1, feet:] = False
    return SimpleNamespace(grid=SimpleNamespace(start=WALKING, end=WALKING, contact=contact))


def plan(deep: float) -> MotionPlan:
    found = object.__new__(MotionPlan)
    values = {"relaxed": (), "report": SolveReport(details={"penetration_m": deep})}
    for name in MotionPlan.__dataclass_fields__:
        object.__setattr__(found, name, values.get(name))
    return found


def answering(monkeypatch: pytest.MonkeyPatch, lax: Any, **failure: Any) -> list[tuple[float, float]]:
    """`_refined` fails with the tighter tolerance, and gives `lax` with the other; what it was asked."""
    asked: list[tuple[float, float]] = []

    def refined(segment: Any, options: MotionOptions, ground: float) -> Any:
        asked.append((options.ground_tolerance, options.stability_share))
        return lax if options.ground_tolerance == OPTIONS.ground_tolerance else tight

    tight = refine._Failure(UnsolvedError("tight", {}), failure.get("pushed", False), failure.get("nearly"))
    monkeypatch.setattr(refine, "_refined", refined)
    return asked


def test_few_feet_ask_for_the_tighter_tolerance_and_many_for_the_usual_one(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = answering(monkeypatch, plan(0.0), pushed=True)
    refine.solve_refined(segment(5), OPTIONS)
    assert asked == [(OPTIONS.ground_tolerance, OPTIONS.stability_shares[0])]
    asked.clear()
    refine.solve_refined(segment(4), OPTIONS)
    assert asked[0] == (OPTIONS.change_tolerance, OPTIONS.stability_shares[0])


def test_a_failure_that_the_ground_has_no_part_in_is_not_tried_again(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = answering(monkeypatch, plan(0.0), pushed=False)
    with pytest.raises(UnsolvedError, match="tight"):
        refine.solve_refined(segment(4), OPTIONS)
    assert {tolerance for tolerance, _ in asked} == {OPTIONS.change_tolerance}


def test_a_plan_of_the_usual_tolerance_says_what_it_missed(monkeypatch: pytest.MonkeyPatch) -> None:
    answering(monkeypatch, plan(5e-4), pushed=True)
    found = refine.solve_refined(segment(4), OPTIONS)
    assert found.relaxed == ("feet 0.5 mm into the ground between samples",)
    assert found.report.details["ground_tolerance_m"] == OPTIONS.change_tolerance


def test_a_plan_found_on_the_way_is_not_made_again(monkeypatch: pytest.MonkeyPatch) -> None:
    on_the_way = plan(5e-4)
    asked = answering(monkeypatch, None, pushed=True, nearly=on_the_way)
    assert refine.solve_refined(segment(4), OPTIONS) is on_the_way
    assert len(asked) == len(OPTIONS.stability_shares)
