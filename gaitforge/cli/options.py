"""The composed config → the `Options` of a run, each part made by `config.build`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from omegaconf import DictConfig

from gaitforge.config import build, plain
from gaitforge.pipeline.options import Options, Search

if TYPE_CHECKING:
    from gaitforge.motion.family import Family


def options(node: DictConfig, allow: Sequence[str]) -> Options:
    """Build simulator, limits, motion, footfall and record options; `InputError` for the first that is wrong."""
    from gaitforge.motion.options import MotionOptions
    from gaitforge.record.recorder import McapRecorder
    from gaitforge.verify.both import Both
    from gaitforge.verify.simulator import Simulator

    whole = plain(node)
    simulators: tuple[Callable[..., Simulator | Both], ...] = (Simulator, Both)
    motion = dict(whole["motion"])
    transition = motion.pop("transition")
    motion["constraints"], motion["costs"] = (_families(motion, group, allow) for group in ("constraints", "costs"))
    return Options(
        simulator=build(whole["verify"], simulators, key="verify", allow=allow),
        recorder=build(whole["record"], McapRecorder, key="record", allow=allow),
        motion=build(motion, MotionOptions, key="motion", allow=allow),
        transition=transition["method"],
        footfall=footfall_options(whole["footfall"], int(whole["seed"]), allow),
        search=build(whole["pipeline"], Search, key="pipeline", allow=allow),
        seed=int(whole["seed"]),
    )


def _families(motion: Mapping[str, Any], group: str, allow: Sequence[str]) -> tuple[Family, ...]:
    """The families of a group, name → family in the config; a null is a family that was taken out."""
    from gaitforge.motion.family import Family

    nodes = motion.get(group) or {}
    return tuple(
        build(node, Family, key=f"motion.{group}.{name}", allow=allow)
        for name, node in nodes.items()
        if node is not None
    )


def footfall_options(node: Mapping[str, Any], seed: int, allow: Sequence[str]) -> dict[str, Any]:
    """Keyword arguments of the pattern synthesis: ``constraints``, ``solver``, ``time_limit_s``, ``seed``."""
    from gaitforge.footfall.constraints import ConstraintSet
    from gaitforge.footfall.solvers.base import FootfallSolver

    built: dict[str, Any] = {**node, "seed": seed}
    families = node.get("constraints") or {}
    built["constraints"] = tuple(
        build(family, ConstraintSet, key=f"footfall.constraints.{name}", allow=allow)
        for name, family in families.items()
    )
    built["solver"] = build(node["solver"], FootfallSolver, key="footfall.solver", allow=allow)
    return built
