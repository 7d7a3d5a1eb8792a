"""Typed schemas of the config: Hydra refuses a key or a type that is not in them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
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
class LoadConf:
    """What the robot carries."""

    mass: float = MISSING
    """[kg]"""
    point: list[float] = MISSING
    """[m] centre of mass in the frame"""
    frame: str = "body"
    """body, a limb or a tool"""


@dataclass
class WalkConf:
    """How a task, or one phase of it, walks; null = the task's value, then the robot's nominal one."""

    cycles: int | None = None
    gait: Any = None
    speed: float | None = None
    heading: float | None = None
    yaw_rate: float | None = None
    body_height: float | None = None
    roll: float | None = None
    pitch: float | None = None
    step_height: float | None = None
    posture: Any = None
    duration: Any = None
    columns: int | None = None
    loads: list[LoadConf] | None = None
    limbs: list[str] | None = None


@dataclass
class PhaseConf(WalkConf):
    """One phase of a task."""

    name: str = MISSING
    kind: str = "walk"
    roles: dict[str, Any] = field(default_factory=dict)
    object: str | None = None
    squeeze: float | None = None
    lift: float | None = None
    grip_height: float | None = None
    grip_spread: float | None = None
    ready_aside: float | None = None
    ready_above: float | None = None
    crouch: float | None = None
    grasp: str | None = None
    onto: str | None = None
    failure: Any = None


@dataclass
class TaskConf(WalkConf):
    """Group ``task``."""

    scene: list[SceneObjectConf] = field(default_factory=list)
    phases: list[PhaseConf] = MISSING
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
    experiment: Any = None
    seed: int = 0
    outputs: str = "outputs"
    debug: bool = False


def run_folder(outputs: str, stamp: str, *, _root_: Any) -> str:
    """Where a run goes: a task's by robot, an experiment's by name, or where one that is resumed began."""
    choices, experiment = _root_.hydra.runtime.choices, _root_.experiment
    if experiment is None:
        return str(Path(outputs, _root_.robot.name, choices.task, stamp))
    return str(experiment.get("resume") or Path(outputs, "experiments", choices.experiment, stamp))


def register(robots: Mapping[str, str]) -> None:
    """Tell Hydra the schema, and every robot (name → assembly file) as an option of group ``robot``."""
    from hydra.core.config_store import ConfigStore
    from omegaconf import OmegaConf

    store = ConfigStore.instance()
    store.store(name="schema", node=Config)
    OmegaConf.register_new_resolver("run_folder", run_folder, replace=True)
    for name, file in robots.items():
        store.store(group="robot", name=name, node={"name": name, "file": file})
