"""The command line answers at once, and does nothing at import."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from gaitforge import __version__
from gaitforge.resources import conf_dir

HEAVY = ("ortools", "casadi", "pinocchio", "pybullet", "mcap", "matplotlib", "yourdfpy", "scipy", "trimesh")

TASKS = ", ".join(sorted(file.stem for file in (conf_dir() / "task").glob("*.yaml")))


def python(code: str, folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, check=False)


def test_help_shows_options_and_exit_codes_without_loading_a_heavy_library(tmp_path: Path) -> None:
    code = (
        "import sys\n"
        "from gaitforge.cli import main\n"
        "try: main(['--help'])\n"
        "except SystemExit: pass\n"
        f"print('loaded', [m for m in {HEAVY!r} if m in sys.modules])\n"
        "import time\n"
        "print('seconds', time.process_time())\n"
    )
    done = python(code, tmp_path)
    seconds = float(done.stdout.split("seconds")[-1])  # of the processor: others on the machine do not count
    assert "loaded []" in done.stdout
    assert "robot: dodecapod, hexapod, quadruped" in done.stdout
    assert f"task: {TASKS}" in done.stdout
    assert "3 infeasible" in done.stdout
    assert seconds < 5.0  # about one second on a free core
    assert list(tmp_path.iterdir()) == []


def test_the_solver_s_threads_are_set_before_numpy_is_loaded(tmp_path: Path) -> None:
    code = (
        "import os, sys\n"
        "for v in ('OMP_NUM_THREADS', 'OPENBLAS_NUM_THREADS', 'MKL_NUM_THREADS'): os.environ.pop(v, None)\n"
        "from gaitforge.cli import main\n"
        "assert 'numpy' not in sys.modules and 'OMP_NUM_THREADS' not in os.environ\n"
        "main(['--version'])\n"
        "try: main(['robot=nothing'])\n"
        "except SystemExit: pass\n"
        "print(os.environ['OMP_NUM_THREADS'], os.environ['OPENBLAS_NUM_THREADS'], os.environ['MKL_NUM_THREADS'])\n"
    )
    done = python(code, tmp_path)
    assert done.stdout.splitlines() == [f"gaitforge {__version__}", "1 1 1"]


def test_the_package_runs_as_a_module(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "gaitforge", "--version"], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert done.stdout == f"gaitforge {__version__}\n"


def test_an_interrupt_ends_with_its_own_code_and_one_line(tmp_path: Path) -> None:
    code = (
        "import sys\n"
        "import gaitforge.cli.job as job\n"
        "def interrupted(*args, **kwargs): raise KeyboardInterrupt\n"
        "job.run_job = interrupted\n"
        "from gaitforge.cli import main\n"
        "sys.exit(main([]))\n"
    )
    done = python(code, tmp_path)
    assert done.returncode == 130
    assert done.stderr == "gaitforge: interrupted\n"


def test_an_interrupt_during_the_optimisation_is_not_lost(tmp_path: Path) -> None:
    code = (
        "import os, signal, sys\n"
        "import gaitforge.motion.gait as gait\n"
        "planned = gait.plan_gait\n"
        "def swallowing(*args, **kwargs):\n"
        "    try: os.kill(os.getpid(), signal.SIGINT)\n"
        "    except KeyboardInterrupt: pass  # as CasADi does\n"
        "    return planned(*args, **kwargs)\n"
        "gait.plan_gait = swallowing\n"
        "from gaitforge.cli import main\n"
        "sys.exit(main(['robot=hexapod', 'task=walk']))\n"
    )
    done = python(code, tmp_path)
    assert done.returncode == 130
    assert done.stderr == "gaitforge: interrupted\n"
    assert not list(tmp_path.rglob("summary.json"))


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="reads the process table")
def test_an_experiment_that_is_terminated_ends_its_processes(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "gaitforge", "experiment=table1", "experiment.workers=2"]
    run = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    children = Path(f"/proc/{run.pid}/task/{run.pid}/children")
    started: list[int] = []

    def within(seconds: float, holds: Callable[[], bool]) -> bool:
        until = time.monotonic() + seconds
        while not (done := holds()) and time.monotonic() < until:
            time.sleep(0.1)
        return done

    def working() -> bool:  # the workers, and what keeps account of shared resources
        started[:] = [int(pid) for pid in children.read_text().split()]
        return len(started) >= 3

    try:
        assert within(60.0, working)
        run.send_signal(signal.SIGTERM)
        _, err = run.communicate(timeout=60)
        assert (run.returncode, err) == (130, "gaitforge: interrupted\n")
        assert within(10.0, lambda: not any(Path(f"/proc/{pid}").exists() for pid in started))
    finally:
        run.kill()


def test_the_footfall_search_leaves_the_handling_of_interrupts_to_python(tmp_path: Path) -> None:
    code = (
        "import re, signal\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored in a session in the background\n"
        "from gaitforge.footfall.synthesis import synthesize_gait_pattern\n"
        "from gaitforge.robot.load import load_robot\n"
        "synthesize_gait_pattern(load_robot('hexapod'), method='program')\n"
        "caught = re.search(r'SigCgt:\\s*(\\w+)', open('/proc/self/status').read())[1]\n"
        "print('kept' if int(caught, 16) >> (signal.SIGINT - 1) & 1 else 'lost')\n"
    )
    assert python(code, tmp_path).stdout == "kept\n"


def test_a_reader_that_stops_reading_does_not_stop_the_run(tmp_path: Path) -> None:
    command = f"{sys.executable} -m gaitforge robot=hexapod task.speed=2.0; echo $? > code"
    subprocess.run(["bash", "-c", f"({command}) | true"], cwd=tmp_path, check=True, capture_output=True)
    assert (tmp_path / "code").read_text().strip() == "3"
    assert list(tmp_path.glob("outputs/hexapod/walk/*/summary.json"))
