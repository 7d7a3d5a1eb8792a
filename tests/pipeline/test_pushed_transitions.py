"""A plan that is pushed up by the ground gives way to the next try, unless it is on the finest grid already."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import pytest

import gaitforge.motion.still as still
import gaitforge.motion.strain as strain
from gaitforge.motion.options import MotionOptions
from gaitforge.pipeline.search.transitions import _Found


@pytest.mark.parametrize(("deep", "samples", "sound"), [(2e-4, 3, True), (5e-4, 3, False), (5e-4, 6, True)])
def test_a_push_counts_where_a_finer_grid_may_be_had(
    monkeypatch: pytest.MonkeyPatch, deep: float, samples: int, sound: bool
) -> None:
    monkeypatch.setattr(still, "static_margin", lambda robot, plan: 0.02)
    monkeypatch.setattr(strain, "strain_of", lambda robot, plan: 0.5)
    details = {"zmp_margin_m": 0.02, "penetration_m": deep, "ground_tolerance_m": 3e-4}
    plan = cast("Any", SimpleNamespace(report=SimpleNamespace(details=details), samples_per_column=samples))
    found = _Found.of(cast("Any", None), "try", plan, 0.1, MotionOptions(finest=6))
    assert found.sound is sound
    assert (found.left.why == "feet 0.5 mm in the ground") is not sound
