"""MuJoCo's warnings as words for an error: left alone it prints them and writes a file where it runs."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from typing import Any

WORDS = {
    "mjWARN_INERTIA": "the mass matrix cannot be inverted",
    "mjWARN_CONTACTFULL": "more contacts than it can hold",
    "mjWARN_CNSTRFULL": "more constraints than it can hold",
    "mjWARN_BADQPOS": "positions ran away",
    "mjWARN_BADQVEL": "velocities ran away",
    "mjWARN_BADQACC": "accelerations ran away",
    "mjWARN_BADCTRL": "a joint was commanded to no number",
}


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """No printing and no log file while the block runs; what was warned of is counted in the data."""
    import mujoco

    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda _: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(before)


def complaint(mj: Any, data: Any) -> str:
    """What MuJoCo warned of during the steps of `data`."""
    found = [name for name, kind in mj.mjtWarning.__members__.items() if name in WORDS and data.warning[kind].number]
    return ", ".join(WORDS[name] for name in found)
