"""Logs: a run as one MCAP file for Foxglove and Lichtblick, and back.

`write_log` writes it, `reader.read_run` reads it, `layout.write_layout` says how a viewer shows it.
"""

from gaitforge.record.archive import plan_archive, write_plan_npz
from gaitforge.record.writer import write_log

__all__ = ["plan_archive", "write_log", "write_plan_npz"]
