"""A PyBullet client that is always closed and prints nothing."""

from __future__ import annotations

import contextlib
import ctypes
import os
import sys
import tempfile
import threading
from collections.abc import Iterator
from importlib.util import find_spec
from typing import Any, BinaryIO

from gaitforge.errors import SimulationError

_descriptors = threading.Lock()


def has_pybullet() -> bool:
    """Is PyBullet installed?  It has no wheels for Python 3.12 on."""
    return find_spec("pybullet") is not None


@contextlib.contextmanager
def direct_client(what: str) -> Iterator[tuple[Any, int]]:
    """The pybullet module and the number of a fresh DIRECT client, disconnected at the end.

    PyBullet's own exception becomes a `SimulationError` that says `what` was being done.
    """
    with quiet():
        try:
            import pybullet
        except ImportError as error:
            raise SimulationError(
                "PyBullet is not installed (it has no wheels for Python 3.12 on); verify=mujoco is"
            ) from error

        client = pybullet.connect(pybullet.DIRECT)
    if client < 0:
        raise SimulationError("PyBullet gave no client")
    try:
        yield pybullet, client
    except pybullet.error as error:
        raise SimulationError(f"PyBullet, {what}: {error}") from error
    finally:
        with quiet():
            pybullet.disconnect(physicsClientId=client)


@contextlib.contextmanager
def quiet() -> Iterator[BinaryIO]:
    """Send what C code prints to a temporary file, which is handed out, while the block runs.

    The process's file descriptors 1 and 2 are turned, one block at a time; Python's own streams
    are flushed before and after so that no line of theirs is lost.
    """
    with _descriptors, tempfile.TemporaryFile() as sink:
        _flush()
        saved = [os.dup(1), os.dup(2)]
        try:
            os.dup2(sink.fileno(), 1)
            os.dup2(sink.fileno(), 2)
            yield sink
        finally:
            _flush()
            for target, copy in zip((1, 2), saved, strict=True):
                os.dup2(copy, target)
                os.close(copy)


def _flush() -> None:
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError, AttributeError):
            stream.flush()
    if os.name == "posix":
        ctypes.CDLL(None).fflush(None)
