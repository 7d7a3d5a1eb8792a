"""Typed schemas of the config: Hydra refuses a key or a type that is not in them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from omegaconf import MISSING


@dataclass
class RobotConf:
    """Group ``robot``: an assembly file."""

    name: str = MISSING
    file: str = MISSING


@dataclass
class PoseConf:
    """A pose in the world frame."""

    xyz: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    """[m]"""
    rpy: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    """[rad]"""


@dataclass
class SceneObjectConf:
    """One object of a task's scene; null = the default of `gaitforge.task.scene.SceneObject`."""

    name: str = MISSING
    kind: str = MISSING
    pose: PoseConf = field(default_factory=PoseConf)
    radius: float | None = None
    length: float | None = None
    thickness: float | None = None
    size: list[float] | None = None
    mass: float | None = None


@dataclass
class PhaseConf:
    """One phase of a task; null = the task's value, then the robot's nominal one."""

    name: str = MISSING
    kind: str = "walk"
    cycles: int | None = None
    roles: dict[str, Any] = field(default_factory=dict)
    gait: Any = None
    speed: float | None = None
    heading: float | None = None
    yaw_rate: float | None = None
    duration: float | None = None
    columns: int | None = None
    failure: Any = None


@dataclass
class TaskConf:
    """Group ``task``."""

    scene: list[SceneObjectConf] = field(default_factory=list)
    phases: list[PhaseConf] = MISSING
    cycles: int | None = None
    gait: Any = None
    speed: float | None = None
    heading: float | None = None
    yaw_rate: float | None = None
    duration: float | None = None
    columns: int | None = None
    limbs: list[str] | None = None
    mode: str | None = None
    at: float | None = None


@dataclass
class Config:
    """The whole config; the groups below ``footfall`` … ``record`` mirror the packages they configure."""

    robot: RobotConf = field(default_factory=RobotConf)
    task: TaskConf = field(default_factory=TaskConf)
    footfall: Any = None
    motion: Any = None
    pipeline: Any = None
    verify: Any = None
    record: Any = None
    seed: int = 0
    outputs: str = "outputs"
    debug: bool = False


def register(robots: Mapping[str, str]) -> None:
    """Tell Hydra the schema, and every robot (name → assembly file) as an option of group ``robot``."""
    from hydra.core.config_store import ConfigStore

    store = ConfigStore.instance()
    store.store(name="schema", node=Config)
    for name, file in robots.items():
        store.store(group="robot", name=name, node={"name": name, "file": file})
