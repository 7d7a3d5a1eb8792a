"""One experiment of the command line: a composed config → jobs → rows → what is told about them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from omegaconf import DictConfig

from gaitforge.cli.options import options
from gaitforge.cli.outcome import JobOutcome, Say
from gaitforge.cli.terminal import Narrator, experiment_text
from gaitforge.config import build, plain
from gaitforge.errors import InputError, Problem

if TYPE_CHECKING:
    from gaitforge.experiment.experiment import Experiment

ELSEWHERE = ("experiment", "experiment.resume", "outputs", "debug")
"""Options that rows do not depend on, or that are told anyway."""


def run_experiment_job(node: DictConfig, allow: Sequence[str], folder: Path, name: str, say: Say) -> JobOutcome:
    """Build the experiment, run it in `folder`, and tell its table."""
    from gaitforge.experiment.engine import ExperimentRun, run_experiment

    narrator = Narrator(say)
    whole = plain(node)
    experiment = build_experiment(whole["experiment"], allow)
    if experiment.resume is not None and not (folder / "rows").is_dir():
        raise InputError(Problem("command line", "experiment.resume", str(folder), "the folder of an earlier run"))
    narrator.title("experiment", name)
    run = ExperimentRun(name, experiment, options(node, allow), folder, whole, command(name))
    outcome = run_experiment(run, narrator.progress)
    say(experiment_text(outcome, experiment.columns))
    seconds = float(outcome.results["seconds"])
    return JobOutcome(outcome.code, outcome.status, "–", f"experiment={name}", str(folder), seconds)


def build_experiment(node: Mapping[str, Any], allow: Sequence[str] = ()) -> Experiment:
    """The experiment that the config describes, with its simulators; `InputError` for what is wrong in it."""
    from gaitforge.experiment.experiment import Experiment
    from gaitforge.verify.simulator import Simulator

    experiment = build(node, Experiment, key="experiment", allow=allow)
    for name, simulator in experiment.simulators.items():
        build(simulator, Simulator, key=f"experiment.simulators.{name}", allow=allow)
    return experiment


def command(name: str) -> str:
    """The command line that makes the same rows, wherever they are put."""
    from hydra.core.hydra_config import HydraConfig

    overrides = [o for o in HydraConfig.get().overrides.task if o.split("=")[0] not in ELSEWHERE]
    return " ".join(["gaitforge", f"experiment={name}", *overrides])
