"""Work given to a few processes, of which none can take the others with it."""

from __future__ import annotations

import os
import signal
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, field
from multiprocessing import active_children, get_context
from types import TracebackType
from typing import Any

from gaitforge.errors import SimulationError
from gaitforge.pipeline.search.tries import THREADS

Call = tuple[Callable[..., Any], tuple[Any, ...]]
"""A function of a module and its arguments, all of which can be pickled."""


@dataclass
class Processes:
    """`count` processes, started when first needed; with one, work is done here. Use as a context."""

    count: int = 1
    _pool: ProcessPoolExecutor | None = field(default=None, repr=False)

    def run(self, calls: Iterable[Call]) -> Iterator[tuple[int, Any]]:
        """(number of the call, what it returned, or the exception that it raised), in the order in which they end.

        Calls are taken one by one, when a process is free for them.  A process that dies takes with it the
        calls that were running; each of them gets a process of its own then, so that only the culprit is lost.
        """
        if self.count < 2:
            for index, call in enumerate(calls):
                yield index, _outcome(*call)
            return
        waiting = enumerate(calls)
        running: dict[Future[Any], tuple[int, Call]] = {}
        suspects: deque[tuple[int, Call]] = deque()
        while True:
            while suspects:
                index, call = suspects.popleft()
                yield index, _alone(call)
            while len(running) < self.count and (item := next(waiting, None)) is not None:
                running[self._submit(item[1])] = item
            if not running:
                return
            done, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                item = running.pop(future)
                try:
                    yield item[0], future.result()
                except BrokenProcessPool:
                    self._pool = None
                    suspects.append(item)

    def _submit(self, call: Call) -> Future[Any]:
        if self._pool is None:
            self._pool = _pool(self.count)
        try:
            return self._pool.submit(_outcome, *call)
        except BrokenProcessPool:
            self._pool = _pool(self.count)
            return self._pool.submit(_outcome, *call)

    def __enter__(self) -> Processes:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._pool is None:
            return
        if error is not None:  # nobody waits for what is still running
            for process in active_children():
                process.terminate()
        self._pool.shutdown(wait=True, cancel_futures=True)
        self._pool = None


def _pool(count: int) -> ProcessPoolExecutor:
    return ProcessPoolExecutor(count, get_context("spawn"), initializer=_begin)


def _outcome(function: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    try:
        return function(*arguments)
    except Exception as error:
        return error


def _alone(call: Call) -> Any:
    with _pool(1) as pool:
        try:
            return pool.submit(_outcome, *call).result()
        except BrokenProcessPool:
            return SimulationError("the process that measured this died")


def _begin() -> None:
    """Before anything heavy is loaded: processes are the parallelism; Ctrl-C is the first process's business.

    That one ends the others with SIGTERM when it is interrupted, or ended so itself.
    """
    os.environ.update(dict.fromkeys(THREADS, "1"))
    signal.signal(signal.SIGINT, signal.SIG_IGN)
