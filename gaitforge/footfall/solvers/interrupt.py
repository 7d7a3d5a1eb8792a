"""Ctrl-C while a native search runs: such a search does not hear it, or takes the signal away from Python."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Generic, TypeVar

T = TypeVar("T")


class Interruptible(Generic[T]):
    """Runs a search beside the main thread, which alone hears Ctrl-C.

    `interrupted` tells whether Ctrl-C was pressed.  `stop` asks the search to end with what it has; without
    one it is left to end by itself, and there is no result.
    """

    def __init__(self, search: Callable[[], T], stop: Callable[[], object] | None = None) -> None:
        self.interrupted = False
        self._search = search
        self._stop = stop
        self._results: list[T] = []
        self._error: Exception | None = None
        self._done = threading.Event()

    def result(self) -> T | None:
        """What the search returned, None when it was left behind; its exception is raised here."""
        threading.Thread(target=self._work).start()
        while not self._done.is_set():
            try:
                self._done.wait(0.1)  # a signal may reach another thread, and not wake this one
            except KeyboardInterrupt:
                self.interrupted = True
                if self._stop is None:
                    return None
                self._stop()
        if self._error is not None:
            raise self._error
        return self._results[0]

    def _work(self) -> None:
        try:
            self._results.append(self._search())
        except Exception as error:
            self._error = error
        finally:
            self._done.set()
