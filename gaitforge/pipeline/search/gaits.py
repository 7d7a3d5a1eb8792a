"""The cascade for a gait: footfall patterns in order of promise until one has a motion plan."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Literal, cast

from gaitforge.errors import InfeasibleFootfall, InfeasibleMotion, UnsolvedError
from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.pipeline.options import Options
from gaitforge.pipeline.search.batch import run_batch
from gaitforge.pipeline.search.certificate import refuse_impossible_speed
from gaitforge.pipeline.search.segment import Attempt, Segment, exhausted
from gaitforge.pipeline.search.tries import Result, Try, Workers, unexplained, why
from gaitforge.pipeline.stopwatch import Stopwatch
from gaitforge.robot.model import RobotModel
from gaitforge.task.phase import Phase
from gaitforge.task.roles import Locomotive, Role, Tool
from gaitforge.task.scene import Scene

if TYPE_CHECKING:
    from gaitforge.footfall.synthesis import Method


def nonlocomotive(robot: RobotModel, phase: Phase, scene: Scene) -> dict[str, Role]:
    """Limb name → role of the limbs that do not walk; named points of the scene are resolved [m]."""
    roles: dict[str, Role] = {}
    for name, role in phase.roles.items():
        if isinstance(role, Tool) and isinstance(role.look_at, str):
            x, y, z = (float(v) for v in scene.point(role.look_at))
            role = replace(role, look_at=(x, y, z))
        if not isinstance(role, Locomotive):
            roles[robot.limb(name).name] = role
    return roles


def plan_phase(
    robot: RobotModel,
    phase: Phase,
    scene: Scene,
    options: Options,
    watch: Stopwatch,
    expected_base: tuple[float, float, float] = (0.0, 0.0, 0.0),
    original: FootfallPattern | None = None,
    workers: Workers | None = None,
) -> Segment:
    """The gait of a phase; `expected_base` is x, y [m], yaw [rad] of the base in the middle of it.

    `original`: the pattern of the gait before, for when one of its limbs is lost.  Patterns are handed to the
    optimiser in batches; of the first batch in which any has a plan, the cheapest is taken, unless its motors cannot
    hold it (`strain_of`), not even with bounds on their efforts (`spared`), and another batch has one that they can.
    Raises `InfeasibleFootfall` or `InfeasibleMotion` with a proof, `UnsolvedError` when every candidate failed.
    """
    from gaitforge.motion.strain import strain_of

    robot = robot.carrying(*phase.loads)  # footholds and body are placed for what is carried, too
    roles = nonlocomotive(robot, phase, scene)
    workers = workers or Workers()
    attempts: list[Attempt] = []
    refusals: list[InfeasibleMotion] = []
    strained: list[tuple[float, Result]] = []
    first: Try | None = None
    for batch in _batches(robot, phase, roles, options, watch, original, attempts):
        patterns = [p for p in batch if not (strained and p.source == "wave")]  # dear to plan, and slower
        if not patterns:
            continue
        asked = [_try(robot, phase, pattern, roles, options, expected_base) for pattern in patterns]
        done = run_batch(asked, phase.name, options, watch, workers)
        attempts += done.left
        refusals += [r.error for r in done.results if isinstance(r.error, InfeasibleMotion)]
        first = first or next(iter(done.tries), None)
        if (taken := done.taken) is None:
            continue
        assert taken.plan is not None
        strain = strain_of(robot, taken.plan)
        if strain <= 1.0:
            return _segment(phase, taken, attempts, strained, watch)
        strained.append((strain, taken))
        watch.progress("motion", f"{phase.name}: {taken.what}: {strain:.2f} of the motors' efforts")
    if strained:
        least = min(range(len(strained)), key=lambda k: strained[k][0])
        best = strained.pop(least)[1]
        return _segment(phase, best, attempts, strained, watch)
    with watch.stage("motion"):
        raise _give_up(phase, attempts, refusals, first)


def _segment(
    phase: Phase, result: Result, attempts: list[Attempt], strained: list[tuple[float, Result]], watch: Stopwatch
) -> Segment:
    assert result.plan is not None
    watch.progress("motion", f"{phase.name}: {result.what}, {result.plan.report.seconds:.2f} s to solve")
    heavier = (Attempt(r.what, f"{strain:.2f} of the motors' efforts", r.seconds) for strain, r in strained)
    return Segment(result.plan, phase.cycles, (*attempts, *heavier))


def _try(
    robot: RobotModel, phase: Phase, pattern: FootfallPattern, roles: Mapping[str, Role], options: Options,
    expected_base: tuple[float, float, float],
) -> Try:  # fmt: skip
    speed = robot.nominal.speed if phase.speed is None else phase.speed
    duration = _duration(robot, phase, pattern)
    if duration != "auto":
        refuse_impossible_speed(robot, pattern.locomotive, speed, duration)
    seconds = "auto" if duration == "auto" else f"{duration:.2f} s"
    what = f"{pattern.source} pattern, {pattern.columns} columns, {seconds}"
    named = {
        "speed": speed, "heading": phase.heading, "yaw_rate": phase.yaw_rate, "duration": duration, "roles": roles,
        "body_height": phase.body_height, "roll": phase.roll, "pitch": phase.pitch, "posture": phase.posture,
        "step_height": phase.step_height,
        "expected_base": expected_base, "name": phase.name, "options": unexplained(options.motion),
    }  # fmt: skip
    return Try(what, "gait", robot, (pattern,), named)


def _give_up(
    phase: Phase, attempts: list[Attempt], refusals: list[InfeasibleMotion], first: Try | None
) -> Exception:  # fmt: skip
    """A certificate against the one pattern that was asked for is an answer; against some of many it is not."""
    if phase.gait != "auto" and len(refusals) == len(attempts):
        return refusals[0]
    known = why(first)
    reason = known.get("text") or attempts[-1].why
    return UnsolvedError(
        f"gait {phase.name}: none of {len(attempts)} footfall patterns has a motion plan: {reason}",
        exhausted(phase.name, attempts, known),
    )


def _duration(robot: RobotModel, phase: Phase, pattern: FootfallPattern) -> float | Literal["auto"]:
    """[s] A pattern with more columns than nominal (a wave) keeps the time of a column, not of a cycle."""
    if phase.duration is not None:
        return phase.duration
    return robot.nominal.duration * max(1.0, pattern.columns / robot.nominal.columns)


def _batches(
    robot: RobotModel, phase: Phase, roles: Mapping[str, Role], options: Options, watch: Stopwatch,
    original: FootfallPattern | None, attempts: list[Attempt],
) -> Iterator[list[FootfallPattern]]:  # fmt: skip
    """Patterns to be compared with each other, the most promising first; none is offered twice."""
    if not isinstance(phase.gait, str):
        yield [FootfallPattern.from_rows({name: phase.gait[name] for name in robot.limb_names})]
        return
    locomotive = tuple(n for n in robot.limb_names if n not in roles)
    first = robot.nominal.gait if phase.gait == "auto" and not roles else phase.gait
    seen: set[bytes] = set()
    for method in dict.fromkeys((first, phase.gait)):
        try:
            found = _synthesised(robot, phase, locomotive, method, options, watch, original)
        except InfeasibleFootfall:
            if method == phase.gait:
                raise
            continue
        attempts += [Attempt(what, why, 0.0) for what, why in found[0].info.get("left", ())]
        fresh = [p for p in found if p.contact.tobytes() not in seen]
        seen.update(p.contact.tobytes() for p in fresh)
        if fresh and _goes_on(fresh[0]):
            yield [fresh.pop(0)]
        size = options.search.gait_batch
        yield from (fresh[k : k + size] for k in range(0, len(fresh), size))


def _goes_on(pattern: FootfallPattern) -> bool:
    """Whether it is the gait before without a limb, and stable: then there is nothing to gain from another."""
    from gaitforge.footfall.ranking import AMPLE

    return pattern.info.get("operation") == "original" and float(pattern.info.get("margin_m", 0.0)) >= AMPLE


def _synthesised(
    robot: RobotModel, phase: Phase, locomotive: tuple[str, ...], method: str, options: Options, watch: Stopwatch,
    original: FootfallPattern | None,
) -> tuple[FootfallPattern, ...]:  # fmt: skip
    """Patterns of one method, the most promising first; only *auto* has more than one kind to offer."""
    from gaitforge.footfall.synthesis import gait_pattern_candidates

    columns = robot.nominal.columns if phase.columns is None else phase.columns
    limit = options.search.gait_candidates if method in ("auto", "program") else 1
    with watch.stage("footfall"):
        found = gait_pattern_candidates(
            robot, locomotive=locomotive, columns=columns, limit=limit, method=cast("Method", method),
            original=original, **options.footfall,
        )  # fmt: skip
    watch.progress("footfall", f"{phase.name}: {len(found)} of method {method}, first {_words(found[0])}")
    return found


def _words(pattern: FootfallPattern) -> str:
    limbs = len(pattern.locomotive)
    return f"{pattern.source}, {limbs} of {len(pattern.limbs)} limbs walk, {pattern.columns} columns"
