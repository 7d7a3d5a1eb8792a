"""Verification in simulation: scene → simulator → recording → trace → checks → verdict.

A simulator fills a `recording.Recording` with states and contacts and nothing else;
`assemble.assemble_trace` derives the `trace.Trace`, the `checks` judge it, and
`verify.verify_timeline` does all of it.

The package can be called: ``gaitforge.verify(robot, [(gait, 4)])`` is `facade.verify`, so that the
public function and the package may share the name.
"""

import sys
from types import ModuleType
from typing import Any


class _Callable(ModuleType):
    def __call__(self, *arguments: Any, **keywords: Any) -> Any:
        from gaitforge.verify.facade import verify

        return verify(*arguments, **keywords)


sys.modules[__name__].__class__ = _Callable
