"""Ctrl-C and SIGTERM, also while a solver runs that keeps them to itself."""

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
    before = {number: signal.signal(number, _handle) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _handle(number: int, frame: FrameType | None) -> None:
    _requested.set()
    raise KeyboardInterrupt


def stop_if_requested() -> None:
    """Raise KeyboardInterrupt when one has been asked for."""
    if _requested.is_set():
        raise KeyboardInterrupt
