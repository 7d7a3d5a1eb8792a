"""C code compiled once per machine and user where there is a compiler; never needed."""

from __future__ import annotations

import ctypes
import os
import platform
import shutil
import subprocess
import tempfile
from functools import cache
from hashlib import blake2b
from pathlib import Path

SHARED = ("-fno-math-errno", "-shared", "-fPIC")
SECONDS = 60.0
"""[s] that a compiler may take"""


@cache
def library(name: str) -> ctypes.CDLL | None:
    """The compiled library of a C file beside this one; None where it cannot be made."""
    return compiled(Path(name).stem, Path(__file__).with_name(name).read_text(encoding="utf-8"), "-O3")


def compiled(stem: str, source: str, optimise: str) -> ctypes.CDLL | None:
    """The library of some C code, compiled with `optimise` (-O1, -O3, …); None where it cannot be made.

    It is kept in the user's cache folder under a digest of source, flags and processor, and put there by
    renaming, so that many processes may do so at once.
    """
    flags = (optimise, *SHARED, *_processor_flags())
    key = blake2b(repr((source, flags, _processor())).encode(), digest_size=12).hexdigest()
    try:
        made = cache_folder() / f"{stem}-{key}.so"
        if not made.is_file():
            compiler = shutil.which(os.environ.get("CC", "cc"))
            if compiler is None:
                return None
            _compile(compiler, flags, source, made)
        return ctypes.CDLL(str(made))
    except (OSError, RuntimeError, subprocess.SubprocessError):  # RuntimeError: a user without a home
        return None


def cache_folder() -> Path:
    """Where compiled code is kept: `$XDG_CACHE_HOME/gaitforge`, by default `~/.cache/gaitforge`."""
    base = os.environ.get("XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache") / "gaitforge"


def _compile(compiler: str, flags: tuple[str, ...], source: str, made: Path) -> None:
    made.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    with tempfile.TemporaryDirectory(dir=made.parent) as scratch:
        code, fresh = Path(scratch) / f"{made.stem}.c", Path(scratch) / made.name
        code.write_text(source, encoding="utf-8")
        command = [compiler, *flags, str(code), "-o", str(fresh), "-lm"]
        subprocess.run(command, check=True, capture_output=True, timeout=SECONDS)
        os.replace(fresh, made)


def _processor_flags() -> tuple[str, ...]:
    return ("-march=native",) if platform.machine() in ("x86_64", "AMD64") else ()


@cache
def _processor() -> str:
    """What `-march=native` depends on."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text(errors="replace").splitlines() if info.is_file() else [platform.processor()]
    wanted = ("model name", "flags")
    return platform.machine() + "".join(sorted({line for line in lines if line.startswith(wanted)}))
