"""The picture of a clash: which cells are painted, and that it stands in the run's folder and report."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from gaitforge.errors import InfeasibleFootfall
from gaitforge.footfall.synthesis import synthesize_gait_pattern, synthesize_transition_pattern
from gaitforge.report.clash_plot import SIMULATED, SOME_STANCE, SOME_SWING, SWING, _colors, clash_png, write_clash_png
from gaitforge.report.page import write_report_html
from gaitforge.report.summary import build_summary
from gaitforge.robot.load import load_robot


@pytest.fixture(scope="module")
def explain() -> dict[str, Any]:
    with pytest.raises(InfeasibleFootfall) as caught:
        synthesize_gait_pattern(load_robot("hexapod"), locomotive=("L3", "R1", "R2", "R3"))
    return dict(caught.value.explain)


def test_two_left_limbs_less_show_the_side_against_the_swing_duty(explain: dict[str, Any]) -> None:
    limbs = explain["pattern"]["limbs"]
    painted = {d["family"]: _colors(d, limbs) for d in explain["demands"]}
    row = limbs.index("L3")
    assert set(painted) == {"g5", "g9"}
    assert {cell[0] for cells in painted.values() for cell in cells} == {row}, "only L3 is concerned"
    assert set(painted["g9"].values()) == {SIMULATED}, "L3 would have to stand in all 12 columns"
    assert sorted(painted["g5"].values()) == sorted([SWING] * 2 + [SOME_SWING] * 10)


def test_cells_of_which_some_have_to_stand_are_pale() -> None:
    demand = {"wants": "stance", "limbs": ["L1", "R1"], "columns": [0, 1, 2], "at_least": 1}
    assert _colors(demand, ["L1", "R1", "R2"]) == {(i, j): SOME_STANCE for i in (0, 1) for j in (0, 1, 2)}


def test_the_fixed_columns_of_a_transition_are_among_the_demands() -> None:
    robot = load_robot("hexapod")
    six, four = (synthesize_gait_pattern(robot, locomotive=names) for names in (None, ("L2", "L3", "R2", "R3")))
    with pytest.raises(InfeasibleFootfall) as caught:
        synthesize_transition_pattern(robot, four, six, columns=4)
    explain = caught.value.explain
    boundary = [d for d in explain["demands"] if d["family"] == "boundary"]
    assert {tuple(d["columns"]) for d in boundary} <= {(0,), (3,)}
    for demand in boundary:
        gait = four.contact[:, 0] if demand["columns"] == [0] else six.contact[:, -1]
        for name in demand["limbs"]:
            assert gait[robot.limb_names.index(name)] == (demand["wants"] == "stance")
    assert clash_png(explain).startswith(b"\x89PNG")


def test_the_picture_is_the_same_every_time_and_stands_in_the_report(explain: dict[str, Any], tmp_path: Path) -> None:
    assert write_clash_png(tmp_path / "clash.png", explain)
    picture = (tmp_path / "clash.png").read_bytes()
    assert picture == clash_png(explain)
    summary = build_summary(robot="hexapod", task="walk", status="infeasible", explain=explain)
    write_report_html(tmp_path / "report.html", summary, clash_png=picture)
    page = (tmp_path / "report.html").read_text()
    assert "What clashes" in page
    assert "data:image/png;base64," in page
    assert "demands" not in page, "what the picture shows is not printed as data"


def test_what_has_no_demands_has_no_picture(tmp_path: Path) -> None:
    assert not write_clash_png(tmp_path / "clash.png", {"families": ["reach"], "advice": "walk slower"})
    assert not list(tmp_path.iterdir())
