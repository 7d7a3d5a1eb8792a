"""`main`: arguments → Hydra → jobs → exit code."""

from __future__ import annotations

import io
import os
import sys
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gaitforge.cli.outcome import JobOutcome

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
INTERRUPTED = 130
NO_RUN = {"--help", "-h", "--hydra-help", "--cfg", "-c", "--info", "-i", "--shell-completion", "-sc"}
"""Flags of Hydra that show something instead of running it"""


def main(argv: Sequence[str] | None = None) -> int:
    """Run gaitforge; the exit code: 0 verified, 1 unverified, 2 bad input, 3 infeasible, 4 internal, 5 unsolved."""
    arguments = list(sys.argv[1:] if argv is None else argv)
    if "--version" in arguments:
        from gaitforge import __version__

        print(f"gaitforge {__version__}")
        return 0
    for variable in THREADS:  # with the default number of threads the motion solver is three times slower
        os.environ.setdefault(variable, "1")
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # a terminal without UTF-8 is no reason to stop a run
            stream.reconfigure(errors="replace")
    debug = os.environ.get("HYDRA_FULL_ERROR") == "1" or "debug=true" in arguments
    from gaitforge.cli.interrupt import interruptible

    try:
        with interruptible():
            return _run(arguments)
    except KeyboardInterrupt:
        print("gaitforge: interrupted", file=sys.stderr)
        return INTERRUPTED
    except Exception as error:
        return _report(error, debug)


def _run(arguments: list[str]) -> int:
    import hydra

    from gaitforge.config import register
    from gaitforge.resources import conf_dir, robot_files

    if (before := sys.modules.get("gaitforge.cli.sweep")) is not None:  # not imported here: Hydra's plugins come first
        before.last_sweep.forget()
    arguments, allow = _allowed_packages(arguments)
    arguments = _with_simulator(arguments)
    register({name: str(file) for name, file in robot_files().items()})
    outcomes: list[JobOutcome] = []
    with _hydra_environment(arguments):
        hydra.main(version_base="1.3", config_path=str(conf_dir()), config_name="config")(_task(allow, outcomes))()
    from gaitforge.cli.sweep import last_sweep

    if not (last_sweep.returns or last_sweep.refused):
        return outcomes[-1].code if outcomes else 0
    return _finish_sweep([r.return_value for r in last_sweep.returns], last_sweep.refused)


def _task(allow: tuple[str, ...], outcomes: list[JobOutcome]) -> Callable[[Any], JobOutcome]:
    def gaitforge_job(node: Any) -> JobOutcome:
        from gaitforge.cli.job import run_job

        outcome = run_job(node, allow, say=_say, complain=_complain)
        outcomes.append(outcome)
        return outcome

    return gaitforge_job


def _say(text: str) -> None:
    try:
        print(text, flush=True)
    except BrokenPipeError:  # a reader like head has seen enough; the run goes on, and its files tell the rest
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)


def _complain(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def _finish_sweep(jobs: list[JobOutcome], refused: list[tuple[str, Exception]]) -> int:
    from gaitforge.cli.compose_errors import input_error
    from gaitforge.cli.terminal import sweep_table

    for overrides, error in refused:
        print(f"gaitforge: {overrides}: {input_error(error)}", file=sys.stderr)
    _say(sweep_table(jobs, [overrides for overrides, _ in refused]))
    return worst([job.code for job in jobs] + [2 for _ in refused])


def worst(codes: Sequence[int]) -> int:
    """The exit code of a sweep: internal error, bad input, infeasible, unsolved, unverified, verified."""
    return max(codes, key=(0, 1, 5, 3, 2, 4).index, default=0)


def _report(error: Exception, debug: bool) -> int:
    from gaitforge.cli.compose_errors import input_error, is_input_error
    from gaitforge.errors import GaitforgeError

    if debug:
        traceback.print_exc()
    if is_input_error(error):
        error = input_error(error)
    if isinstance(error, GaitforgeError):
        print(f"gaitforge: {error}", file=sys.stderr)
        return error.exit_code
    print(f"gaitforge: internal error: {type(error).__name__}: {error} (debug=true shows more)", file=sys.stderr)
    return 4


def _allowed_packages(arguments: list[str]) -> tuple[list[str], tuple[str, ...]]:
    """Take ``--allow-package NAME`` out: on the command line alone, because a file must not widen its own rights."""
    rest: list[str] = []
    allow: list[str] = []
    items = iter(arguments)
    for item in items:
        if item == "--allow-package":
            allow.append(next(items, ""))
        elif item.startswith("--allow-package="):
            allow.append(item.partition("=")[2])
        else:
            rest.append(item)
    return rest, tuple(name for name in allow if name)


def _with_simulator(arguments: list[str]) -> list[str]:
    """MuJoCo where PyBullet is not installed and nobody asked for a simulator, nor for anything but a run."""
    asked = {item.lstrip("+~").split("=")[0] for item in arguments}
    if asked & {*NO_RUN, "verify", "experiment"} or find_spec("pybullet") is not None:
        return arguments
    _say("gaitforge: PyBullet is not installed (no wheels for Python 3.12 on), MuJoCo judges: verify=mujoco")
    return [*arguments, "verify=mujoco"]


@contextmanager
def _hydra_environment(arguments: list[str]) -> Iterator[None]:
    """Hydra reads `sys.argv`, and with full errors on it raises instead of printing a traceback and exiting."""
    argv, full = sys.argv, os.environ.get("HYDRA_FULL_ERROR")
    sys.argv = ["gaitforge", *arguments]
    os.environ["HYDRA_FULL_ERROR"] = "1"
    try:
        yield
    finally:
        sys.argv = argv
        if full is None:
            del os.environ["HYDRA_FULL_ERROR"]
        else:
            os.environ["HYDRA_FULL_ERROR"] = full
