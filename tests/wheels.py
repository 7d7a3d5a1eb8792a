"""Robot files that others wrote and that lie in the wheels of pybullet and example-robot-data."""

from __future__ import annotations

import warnings
from importlib.metadata import files
from pathlib import Path


def bullet(name: str) -> Path:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import pybullet_data
    return Path(pybullet_data.getDataPath()) / name


def example(name: str) -> Path:
    """A URDF of the example-robot-data wheel, wherever that put it."""
    for file in files("example-robot-data") or ():
        if str(file).endswith(f"robots/{name}"):
            return Path(str(file.locate())).resolve()
    raise FileNotFoundError(name)
