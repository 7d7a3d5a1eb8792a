"""Rules as data: which rows they speak of, and what breaks them."""

from __future__ import annotations

from typing import Any

import pytest

from gaitforge.experiment.acceptance import Rule, accepted

ROW = {"method": "optimise", "speed_share": 0.97, "heading_deg": 1.0, "fallen": False, "slip_m": None}


@pytest.mark.parametrize(
    ("rule", "broken"),
    [
        ({"at_least": {"speed_share": 0.97}}, []),
        ({"at_least": {"speed_share": 0.98}}, ["speed_share 0.97 < 0.98"]),
        ({"at_most": {"heading_deg": 0.5}}, ["heading_deg 1 > 0.5"]),
        ({"at_most": {"slip_m": 0.1}}, ["slip_m unknown > 0.1"]),
        ({"equal": {"fallen": True}}, ["fallen is False, not True"]),
        ({"equal": {"method": ["interpolate", "optimise"]}}, []),
    ],
)
def test_a_rule_says_what_a_row_does_not_keep(rule: dict[str, Any], broken: list[str]) -> None:
    assert Rule.read(rule, "accept.0").broken(ROW) == broken
    assert accepted(ROW, [Rule.read(rule, "accept.0")]) == (not broken, broken)


def test_a_rule_speaks_only_of_the_rows_it_names() -> None:
    rule = Rule.read({"where": {"method": "interpolate"}, "at_least": {"speed_share": 2.0}}, "accept.0")
    assert accepted(ROW, [rule]) == (None, [])
    both = Rule.read({"where": {"method": ["interpolate", "optimise"]}, "at_least": {"speed_share": 0.9}}, "accept.1")
    assert accepted(ROW, [rule, both]) == (True, [])


@pytest.mark.parametrize("data", [["speed"], {"at_leest": {"speed_share": 1.0}}, {"at_least": 0.95}])
def test_what_is_no_rule_is_refused(data: Any) -> None:
    with pytest.raises(ValueError, match=r"accept\.0"):
        Rule.read(data, "accept.0")
