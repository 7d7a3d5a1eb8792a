"""The command line: the only place that prints, shows progress and sets exit codes."""

from gaitforge.cli.app import main

__all__ = ["main"]
