"""docs/verification.md says what the code does."""

import re
from pathlib import Path

import numpy as np
import pytest
from walkers import perfect_trace, stand_plan, timeline_of, walker

from gaitforge.verify import checks
from gaitforge.verify.verify import judge

PAGE = (Path(__file__).parents[2] / "docs" / "verification.md").read_text()


def test_every_check_is_on_the_page() -> None:
    named = set(re.findall(r"`([a-z_]+)`", PAGE))
    assert {check.name for check in checks.ALL} <= named


def test_the_new_check_of_the_page_works_as_it_stands_there() -> None:
    (code,) = re.findall(r"```python\n(@dataclass.*?)```", PAGE, flags=re.DOTALL)
    scope: dict[str, object] = {}
    exec(
        "from dataclasses import dataclass\nfrom typing import ClassVar\nimport numpy as np\n"
        "from gaitforge.verify.checks import *\n" + code,
        scope,
    )
    robot = walker(2)
    timeline = timeline_of(robot, (stand_plan(robot, 1.0, advance=0.02), 1))
    trace = perfect_trace(robot, timeline)
    (found,) = judge(robot, timeline, trace, "by hand", checks=[scope["TopSpeed"]()]).checks  # type: ignore[operator]
    speed = np.abs(np.diff(trace.plan.base_poses[:, 0])).max() * 240
    assert (found.name, found.value) == ("top_speed", pytest.approx(speed))
