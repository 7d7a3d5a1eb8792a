"""``manifest.json``: what made a run, so that it can be made again."""

from __future__ import annotations

import hashlib
import json
import os
import platform
import subprocess
import sys
from collections.abc import Mapping
from datetime import UTC, datetime
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

PACKAGES = (
    "hydra-core", "numpy", "scipy", "yourdfpy", "pin", "casadi", "ortools", "pybullet", "mujoco", "mcap", "matplotlib",
)  # fmt: skip
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def manifest(config: Mapping[str, Any], urdf: str, seed: int) -> dict[str, Any]:
    """Versions, seed, hashes of code, config and robot, git commit if there is one, platform and thread counts."""
    from gaitforge import __version__

    return {
        "schema": 1,
        "gaitforge": __version__,
        "git_commit": git_commit(Path(__file__).parent),
        "code_sha256": code_hash(),
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "seed": seed,
        "config_sha256": config_hash(config),
        "robot_urdf_sha256": hashlib.sha256(urdf.encode()).hexdigest(),
        "python": sys.version.split()[0],
        "platform": platform.platform(),
        "processors": os.cpu_count(),
        "threads": {name: os.environ.get(name) for name in THREADS},
        "versions": versions(),
    }


def config_hash(config: Mapping[str, Any]) -> str:
    """SHA-256 of the config; folders are left out, so that the same run elsewhere has the same hash."""
    kept = {k: v for k, v in config.items() if k not in ("outputs", "debug")}
    if isinstance(kept.get("robot"), Mapping):
        kept["robot"] = {k: v for k, v in kept["robot"].items() if k != "file"}
    return hashlib.sha256(json.dumps(kept, sort_keys=True, default=str).encode()).hexdigest()


@cache
def code_hash(package: Path = Path(__file__).parents[1]) -> str:
    """SHA-256 of the names and contents of all sources in a package's folder: gaitforge's own, installed or not."""
    digest = hashlib.sha256()
    for file in sorted(f for f in package.rglob("*") if f.suffix in (".py", ".c")):
        digest.update(f"{file.relative_to(package).as_posix()}\0".encode())
        digest.update(hashlib.sha256(file.read_bytes()).digest())
    return digest.hexdigest()


def git_commit(folder: Path) -> str | None:
    """The commit of the checkout that gaitforge runs from, with ``+`` when files differ from it; else None."""
    if not (folder.parent / ".git").exists():
        return None
    try:
        commit = _git(folder, "rev-parse", "HEAD")
        return commit + ("+" if _git(folder, "status", "--porcelain", "--untracked-files=no") else "")
    except (OSError, subprocess.SubprocessError):
        return None


def _git(folder: Path, *arguments: str) -> str:
    done = subprocess.run(["git", *arguments], cwd=folder, capture_output=True, text=True, timeout=5, check=True)
    return done.stdout.strip()


def versions() -> dict[str, str | None]:
    """Package → version; None for one that is not installed."""
    return {name: _version(name) for name in PACKAGES}


def _version(name: str) -> str | None:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return None
