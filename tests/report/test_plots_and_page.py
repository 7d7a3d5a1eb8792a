"""Plots, tables and the report page show what is in the run."""

from __future__ import annotations

import csv
import io
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest
from PIL import Image

from gaitforge.errors import InputError
from gaitforge.report.footfall_plot import Sizes, footfall_png, write_footfall_csv, write_footfall_png
from gaitforge.report.page import write_report_html
from gaitforge.report.speed_plot import speed_png, write_speed_png
from gaitforge.report.summary import build_summary, segment_entries
from gaitforge.report.text import checks_text, number, segments_text, table


@pytest.fixture
def summary(verdict):
    segments = segment_entries(verdict.timeline, verdict.speeds)
    return build_summary(robot="hexapod", task="<walk>", status="unverified", segments=segments, checks=verdict.checks)


def red_share(png: bytes) -> float:
    pixels = np.array(Image.open(io.BytesIO(png)).convert("RGB")).astype(int)
    return float(np.mean((pixels[..., 0] > 140) & (pixels[..., 1] < 70) & (pixels[..., 2] < 70)))


def rows_of(path):
    return list(csv.DictReader(path.read_text().splitlines()))


def with_contact(verdict, contact):
    """The timeline of the first gait alone, with another C."""
    entry = verdict.timeline.entries[1]
    plan = replace(entry.plan, pattern=replace(entry.plan.pattern, contact=contact))
    return replace(verdict.timeline, entries=(replace(entry, plan=plan, start=0.0),), aims=(), overrides=())


def test_red_boxes_are_swing(verdict):
    stance = np.ones((6, 12), dtype=bool)
    half = verdict.timeline.entries[1].plan.pattern.contact
    assert np.mean(half) == 0.5
    none, some, all_ = (red_share(footfall_png(with_contact(verdict, c))) for c in (stance, half, ~stance))
    assert none == 0.0
    assert some == pytest.approx(all_ / 2, rel=0.05)
    assert all_ > 0.4


def test_one_box_is_where_its_limb_and_column_are(verdict):
    contact = np.ones((6, 12), dtype=bool)
    contact[4, 7] = False
    size = Sizes()
    pixels = np.array(Image.open(io.BytesIO(footfall_png(with_contact(verdict, contact), size))).convert("RGB"))
    dpi = pixels.shape[1] / (size.left + 2 * size.margin + 12 * size.box)
    x = int((size.left + size.margin + 7.5 * size.box) * dpi)
    y = int((size.title + 4.5 * size.box) * dpi)
    assert tuple(pixels[y, x]) == (0xCD, 0x2D, 0x28)
    assert tuple(pixels[y, x + int(size.box * dpi)]) == (255, 255, 255)
    assert tuple(pixels[y + int(size.box * dpi), x]) == (255, 255, 255)


def test_the_first_and_last_column_of_a_transition_are_shaded(verdict):
    move = verdict.timeline.entries[2]
    timeline = replace(verdict.timeline, entries=(replace(move, start=0.0),), aims=(), overrides=())
    pixels = np.array(Image.open(io.BytesIO(footfall_png(timeline))).convert("RGB")).reshape(-1, 3)
    dark, grey = np.all(pixels == (0x9E, 0x1F, 0x1B), axis=1).sum(), np.all(pixels == (0xD9, 0xDD, 0xE1), axis=1).sum()
    contact = move.plan.pattern.contact[:, [0, -1]]
    assert dark / grey == pytest.approx((~contact).sum() / contact.sum(), rel=0.05)


def test_plots_of_the_same_run_have_the_same_bytes(tmp_path, verdict):
    write_footfall_png(tmp_path / "f.png", verdict.timeline)
    write_speed_png(tmp_path / "s.png", verdict)
    assert (tmp_path / "f.png").read_bytes() == footfall_png(verdict.timeline)
    assert (tmp_path / "s.png").read_bytes() == speed_png(verdict)


def test_no_plot_touches_pyplot(verdict):
    import sys

    before = "matplotlib.pyplot" in sys.modules
    footfall_png(verdict.timeline)
    speed_png(verdict)
    assert before or "matplotlib.pyplot" not in sys.modules


def test_a_run_that_stands_is_drawn_without_its_speed(verdict):
    stand = replace(verdict.timeline, entries=verdict.timeline.entries[:1], aims=(), overrides=())
    rows = verdict.trace.times < stand.duration
    plan = stand.sample(verdict.trace.times[rows])
    trace = replace(
        verdict.trace, times=verdict.trace.times[rows], plan=plan, base_poses=verdict.trace.base_poses[rows]
    )
    assert Image.open(io.BytesIO(speed_png(replace(verdict, timeline=stand, trace=trace, speeds=())))).size[0] > 500


def test_the_csv_is_c(tmp_path, verdict):
    write_footfall_csv(tmp_path / "footfall.csv", verdict.timeline)
    rows = rows_of(tmp_path / "footfall.csv")
    assert set(rows[0]) == {"segment", "limb", "column", "contact"}
    for entry in verdict.timeline.entries:
        pattern = entry.plan.pattern
        mine = [r for r in rows if r["segment"] == entry.plan.name]
        found = np.zeros_like(pattern.contact)
        for row in mine:
            found[pattern.limbs.index(row["limb"]), int(row["column"])] = row["contact"] == "1"
        assert len(mine) == pattern.contact.size
        assert np.array_equal(found, pattern.contact)


def test_a_segment_name_with_a_comma_stays_one_cell(tmp_path, verdict):
    entry = verdict.timeline.entries[0]
    odd = replace(entry, plan=replace(entry.plan, name='all, "five"'))
    write_footfall_csv(tmp_path / "footfall.csv", replace(verdict.timeline, entries=(odd,)))
    assert {r["segment"] for r in rows_of(tmp_path / "footfall.csv")} == {'all, "five"'}


class Reader(HTMLParser):
    """Tags that are open, sources, and words."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.sources: list[str] = []
        self.words: list[str] = []

    def handle_starttag(self, tag, attrs):
        if tag not in ("meta", "img"):
            self.open.append(tag)
        self.sources += [v for k, v in attrs if k in ("src", "href")]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.words.append(data)


def read(path) -> Reader:
    reader = Reader()
    reader.feed(path.read_text())
    assert reader.open == []
    return reader


def test_the_page_is_well_formed_and_needs_nothing_from_elsewhere(tmp_path, summary, verdict):
    plots = {"footfall_png": footfall_png(verdict.timeline), "speed_png": speed_png(verdict)}
    write_report_html(tmp_path / "report.html", summary, **plots, pictures=[("after 2 s", plots["speed_png"])])
    page = read(tmp_path / "report.html")
    assert len(page.sources) == 3
    assert all(source.startswith("data:image/png;base64,") for source in page.sources)
    assert "http" not in (tmp_path / "report.html").read_text()


def test_the_page_tells_verdict_speeds_failed_checks_and_how_to_open_the_log(tmp_path, summary):
    write_report_html(tmp_path / "report.html", summary)
    words = " ".join(read(tmp_path / "report.html").words)
    for expected in ("hexapod · <walk>", "unverified", "1 of 2 checks hold", "6.34", "all to five", "gap rule", "2.4",
                     "run.mcap", "run.layout.json"):  # fmt: skip
        assert expected in words
    assert (tmp_path / "report.html").read_text().count('<tr class="failed">') == 1


def test_the_page_shows_the_clip_that_lies_beside_it(tmp_path, summary):
    write_report_html(tmp_path / "report.html", summary, clip="clip.webp")
    assert read(tmp_path / "report.html").sources == ["clip.webp"]


def test_the_page_of_a_run_without_a_solution_says_why(tmp_path):
    explain = {"families": ["g5", "g9"], "advice": "free a limb"}
    summary = build_summary(robot="r", task="t", status="infeasible", explain=explain)
    write_report_html(tmp_path / "report.html", summary)
    words = " ".join(read(tmp_path / "report.html").words)
    assert "g5" in words
    assert "nothing was simulated" in words
    assert "run.mcap" not in words


def test_a_page_that_cannot_be_written_is_bad_input(tmp_path, summary):
    with pytest.raises(InputError):
        write_report_html(tmp_path / "nowhere" / "report.html", summary)


def test_tables_line_up_and_numbers_stand_to_the_right():
    lines = table(("name", "value"), [("a", "1.5"), ("longer", "12"), ("c", "–")]).splitlines()
    assert lines[2:] == ["a         1.5", "longer     12", "c           –"]


def test_the_tables_of_a_run_show_speeds_and_mark_what_failed(summary):
    segments, checks = segments_text(summary), checks_text(summary)
    assert "6.40" in segments
    assert "6.34" in segments
    marks = {line[0]: line for line in checks.splitlines()[2:]}
    assert set(marks) == {"✓", "✗", "·"}
    assert "tilt" in marks["✗"]
    assert checks_text(summary, failed_only=True).count("\n") == 2


@pytest.mark.parametrize(("value", "text"), [(None, "–"), (0.123456, "0.1235"), (12.0, "12")])
def test_numbers_are_told_in_four_digits(value, text):
    assert number(value) == text
