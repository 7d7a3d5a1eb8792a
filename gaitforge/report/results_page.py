"""The page of an experiment: one Markdown table of its rows, and what was missed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Column:
    """One column of a table: which value of a row, and how a person reads it."""

    key: str
    title: str
    scale: float = 1.0
    """What a number is multiplied by, 100 for cm/s from m/s"""
    digits: int = 2

    def text(self, row: Mapping[str, Any]) -> str:
        """The cell; – where the row has no such value."""
        value = row.get(self.key)
        if value is None:
            return "–"
        if isinstance(value, bool):
            return "yes" if value else "no"
        if isinstance(value, float):
            return f"{self.scale * value:.{self.digits}f}"
        return " ".join(map(str, value)) if isinstance(value, list | tuple) else str(value)


def markdown_table(columns: Sequence[Column], rows: Sequence[Mapping[str, Any]]) -> str:
    """A Markdown table of rows, numbers to the right."""
    numeric = [any(_is_number(row.get(c.key)) for row in rows) for c in columns]
    lines = [
        "| " + " | ".join(c.title for c in columns) + " |",
        "|" + "|".join("---:" if right else "---" for right in numeric) + "|",
        *("| " + " | ".join(_cell(c.text(row)) for c in columns) + " |" for row in rows),
    ]
    return "\n".join(lines)


def results_page(results: Mapping[str, Any], columns: Sequence[Column], picture: str | None = None) -> str:
    """The page for ``results.json``: outcome, table, picture, what was missed, and how it was made."""
    rows = results["rows"]
    counts = results["counts"]
    shown = [c for c in columns if any(row.get(c.key) is not None for row in rows)]
    parts = [
        f"# {results['title']}",
        f"**{results['status']}**: {counts['measured']} of {counts['rows']} rows measured, "
        f"{counts['accepted']} of {counts['judged']} accepted.",
        markdown_table([*shown, Column("accepted", "accepted")], rows),
        f"![{results['title']}]({picture})" if picture else "",
        _missed(rows),
        _made(results),
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def _missed(rows: Sequence[Mapping[str, Any]]) -> str:
    said = []
    for row in rows:
        reasons = [*row.get("broken", ()), *([str(row["error"])] if row.get("error") else [])]
        if row.get("accepted") is False or not row["measured"]:
            said.append(f"- `{row['key']}`: " + "; ".join(reasons))
    return "## Missed\n\n" + "\n".join(said) if said else ""


def _made(results: Mapping[str, Any]) -> str:
    versions = ", ".join(f"{name} {version}" for name, version in results["versions"].items() if version)
    command = f"```sh\n{results['command']}\n```\n\n" if results["command"] else ""
    return f"## Made by\n\n{command}{results['created']}, {results['seconds']:.0f} s; {versions}."


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
