"""Ctrl-C, also while a solver runs that keeps it to itself."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

_requested = threading.Event()


@contextmanager
def interruptible() -> Iterator[None]:
    """Remember an interrupt besides raising it: CasADi swallows what is raised while IPOPT iterates."""
    _requested.clear()
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, _handle)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _handle(number: int, frame: FrameType | None) -> None:
    _requested.set()
    raise KeyboardInterrupt


def stop_if_requested() -> None:
    """Raise KeyboardInterrupt when one has been asked for."""
    if _requested.is_set():
        raise KeyboardInterrupt
