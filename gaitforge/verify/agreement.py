"""Where simulators that were asked about the same timeline give different answers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from gaitforge.verify.verdict import Check, Verdict


@dataclass(frozen=True)
class Disagreement:
    """One question that holds in one simulator and fails in another."""

    name: str
    """Of the check"""
    segment: str
    answers: tuple[Check, ...]
    """One a simulator"""

    def __str__(self) -> str:
        said = (f"{a.simulator} {a.value:.4g} {a.unit} {'holds' if a.passed else 'fails'}" for a in self.answers)
        return f"{self.name} of {self.segment}: {', '.join(said)}"


def disagreements(checks: Iterable[Check]) -> tuple[Disagreement, ...]:
    """Questions that were answered differently, in the order in which they were asked.

    A segment that comes twice is asked twice: the first answers belong together, and the second ones.
    """
    asked: dict[tuple[str, str, int], list[Check]] = {}
    turns: Counter[tuple[str, str, str]] = Counter()
    for check in checks:
        who = (check.simulator, check.segment, check.name)
        asked.setdefault((check.segment, check.name, turns[who]), []).append(check)
        turns[who] += 1
    return tuple(
        Disagreement(name, segment, tuple(answers))
        for (segment, name, _), answers in asked.items()
        if len({answer.passed for answer in answers}) > 1
    )


def opinions(verdict: Verdict) -> dict[str, Any] | None:
    """``opinions`` of ``summary.json``: what each simulator said, and where they differ; None when one was asked.

    Speeds are those of each segment [m/s]; their difference is the largest minus the smallest.
    """
    if not verdict.others:
        return None
    asked = (verdict, *verdict.others)
    names = [entry.plan.name for entry in verdict.timeline.entries]
    speeds = [dict(zip(verdict.simulators, each, strict=True)) for each in zip(*(v.speeds for v in asked), strict=True)]
    return {
        "passed": {s: all(c.passed for c in verdict.checks if c.simulator == s) for s in verdict.simulators},
        "disagreements": [
            {
                "name": found.name,
                "segment": found.segment,
                "values": {answer.simulator: answer.value for answer in found.answers},
                "passed": {answer.simulator: answer.passed for answer in found.answers},
            }
            for found in disagreements(verdict.checks)
        ],
        "speeds_m_s": [
            {"segment": name, "values": found, "difference": max(found.values()) - min(found.values())}
            for name, found in zip(names, speeds, strict=True)
        ],
    }
