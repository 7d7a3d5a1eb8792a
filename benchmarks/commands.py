"""Commands walked: headings, speeds, turning, body and step heights of both paper robots in PyBullet.

    OMP_NUM_THREADS=1 python -m benchmarks.commands [--workers 2] [--only hexapod] [--fresh] [--page]

Every case is planned and, when there is a plan, walked; rows are kept in outputs/commands/rows.json, so that
a run goes on where it stopped (--fresh begins anew, --page only writes docs/results/commands.md).
"""

from __future__ import annotations

import argparse
import json
import os
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from pathlib import Path

from benchmarks.commands_cases import ROBOTS, Case, Row, cases, measure, row_of
from benchmarks.commands_page import write_page

ROWS = Path(__file__).parents[1] / "outputs" / "commands" / "rows.json"


def main(argv: Sequence[str] | None = None) -> None:
    """Measure what is not there yet, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--only", choices=ROBOTS, help="one robot")
    parser.add_argument("--fresh", action="store_true", help="forget the rows of an earlier run")
    parser.add_argument("--page", action="store_true", help="write the page from the rows there are")
    arguments = parser.parse_args(argv)
    rows = {} if arguments.fresh else _kept()
    if not arguments.page:
        wanted = [c for name in ROBOTS if arguments.only in (None, name) for c in _cases(name)]
        _run([c for c in wanted if c.key not in rows], rows, arguments.workers)
    known = [rows[c.key] for name in ROBOTS for c in _cases(name) if c.key in rows]
    print(write_page(known))


def _cases(robot: str) -> list[Case]:
    from gaitforge.robot.load import load_robot

    return list(cases(robot, load_robot(robot).nominal.body_height))


def _run(missing: Sequence[Case], rows: dict[str, Row], workers: int) -> None:
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    with ProcessPoolExecutor(workers, get_context("spawn")) as pool:
        for future in as_completed([pool.submit(measure, case) for case in missing]):
            row = future.result()
            rows[row.case.key] = row
            _keep(rows)
            error = "–" if row.velocity_percent is None else f"{row.velocity_percent:.1f} %"
            print(f"{row.case.key}: {row.status}, {error} {row.why} {' '.join(row.failed)}", flush=True)


def _kept() -> dict[str, Row]:
    if not ROWS.exists():
        return {}
    return {row.case.key: row for row in map(row_of, json.loads(ROWS.read_text(encoding="utf-8")))}


def _keep(rows: dict[str, Row]) -> None:
    from gaitforge.record.files import write_json

    ROWS.parent.mkdir(parents=True, exist_ok=True)
    write_json(ROWS, [row.as_dict() for row in rows.values()])


if __name__ == "__main__":
    main()
