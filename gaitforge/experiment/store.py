"""Rows on disk: a file a job, whole or absent, so that a run that was ended goes on where it was."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from gaitforge.experiment.experiment import Row
from gaitforge.record.files import write_json
from gaitforge.report.summary import plain


@dataclass(frozen=True)
class RowStore:
    """``rows/<key>.json``: ``{"fingerprint": …, "rows": […]}``."""

    folder: Path
    fingerprints: Mapping[str, str]
    """Of everything that the rows of a job depend on, by its key: what another one made is measured again."""

    def finished(self, key: str) -> list[Row] | None:
        """The rows of a job that an earlier run has measured; None when there are none."""
        try:
            found = json.loads(self._file(key).read_text())
        except (OSError, ValueError):
            return None
        if found.get("fingerprint") != self.fingerprints[key] or not all(row["measured"] for row in found["rows"]):
            return None
        return list(found["rows"])

    def has(self, key: str) -> bool:
        """Whether there are rows of a job at all, be they finished or not."""
        return self._file(key).exists()

    def write(self, key: str, rows: Sequence[Row]) -> None:
        """Keep the rows of a job; InputError when the folder cannot be written."""
        self.folder.mkdir(parents=True, exist_ok=True)
        write_json(self._file(key), plain({"fingerprint": self.fingerprints[key], "rows": list(rows)}))

    def _file(self, key: str) -> Path:
        return self.folder / f"{key}.json"
