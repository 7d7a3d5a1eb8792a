"""The config: typed schemas, and `build`, the one door through which it becomes objects."""

from gaitforge.config.build import build, plain
from gaitforge.config.schema import register

__all__ = ["build", "plain", "register"]
