"""One job of the command line: a composed config → robot, task, options → a run → what is told about it."""

from __future__ import annotations

import shutil
import traceback
from collections.abc import Sequence
from pathlib import Path

from omegaconf import DictConfig

from gaitforge.cli.compose_errors import input_error, is_input_error
from gaitforge.cli.outcome import JobOutcome, Say
from gaitforge.errors import GaitforgeError, InputError


def run_job(node: DictConfig, allow: Sequence[str], *, say: Say, complain: Say) -> JobOutcome:
    """Run the job that Hydra composed; errors become an exit code, because an exit would end a multirun.

    Bad input that is found before the run starts takes the folder that Hydra made with it.
    """
    from hydra.core.hydra_config import HydraConfig

    from gaitforge.cli.experiment import run_experiment_job

    hydra = HydraConfig.get()
    folder, task = Path(hydra.runtime.output_dir), str(hydra.runtime.choices["task"])
    robot = str(node.robot.name)
    try:
        if node.experiment is not None:
            return run_experiment_job(node, allow, folder, str(hydra.runtime.choices["experiment"]), say)
        return _run(node, allow, folder, task, say)
    except Exception as error:
        told = input_error(error) if is_input_error(error) else error
        if isinstance(told, InputError):
            discard(folder)
        if node.debug:
            complain(traceback.format_exc())
        complain(f"gaitforge: {_words(told)}")
        code = told.exit_code if isinstance(told, GaitforgeError) else GaitforgeError.exit_code
        return JobOutcome(code, "error", robot, task, str(folder), message=str(told))


def _words(error: Exception) -> str:
    if isinstance(error, GaitforgeError):
        return str(error)
    return f"internal error: {type(error).__name__}: {error} (debug=true shows more)"


def _run(node: DictConfig, allow: Sequence[str], folder: Path, task_name: str, say: Say) -> JobOutcome:
    from gaitforge.cli.options import options
    from gaitforge.cli.terminal import Narrator, summary_text
    from gaitforge.config import plain
    from gaitforge.pipeline.run import Run
    from gaitforge.pipeline.run_task import run_task
    from gaitforge.pipeline.stopwatch import Stopwatch
    from gaitforge.robot.load import load_robot
    from gaitforge.task.load import load_task

    narrator = Narrator(say)
    watch = Stopwatch(narrator.progress)
    narrator.title(node.robot.name, task_name)
    with watch.stage("assemble"):
        robot = load_robot(node.robot.file)
    narrator.robot(robot)
    task = load_task(plain(node.task), task_name, robot=robot, file=f"task={task_name}")
    run = Run(robot, task, options(node, allow), folder, plain(node))
    outcome = run_task(run, watch)
    say(summary_text(outcome))
    seconds = float(outcome.summary["timings_s"]["total"])
    return JobOutcome(
        outcome.code, outcome.status, str(node.robot.name), task_name, str(folder), seconds, outcome.message
    )


def discard(folder: Path) -> None:
    """Remove what Hydra wrote into the folder of a job that never started, and folders that are empty then."""
    shutil.rmtree(folder / ".hydra", ignore_errors=True)
    for empty in (folder, *folder.parents[:3]):
        try:
            empty.rmdir()
        except OSError:
            return
