"""`duration: auto`: the shortest cycle that keeps joint speeds and torques below their bounds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

from gaitforge.errors import InfeasibleMotion, UnsolvedError
from gaitforge.motion.options import MotionOptions
from gaitforge.motion.plan import MotionPlan

RESOLUTION = 0.06
"""The answer is at most this share longer than a duration that was tried and left."""
SOLVES = 9
FARTHER = 1.3
"""How much shorter the next duration is at least, while none was too short yet."""
HELPS = 0.95
"""A longer cycle is of use when it lowers the load to at most this share."""
LONGEST = 4.0
"""Times the robot's nominal duration: what needs more is refused."""
STEADY_M = 0.003
"""[m] a cycle is too short when the zero-moment point comes nearer to the border of the polygon"""


def load_of(options: MotionOptions, plan: MotionPlan) -> float:
    """The largest of joint speed and torque over their bounds; inf where the zero-moment point is at the border."""
    details = plan.report.details
    if details["zmp_margin_m"] < STEADY_M:
        return float("inf")
    speed, effort = float(details["speed_ratio"]), float(details["effort_ratio"])
    return max(speed / options.speed_share, effort / options.effort_share)


@dataclass
class _Search:
    """Bracketing in the logarithm of the duration; plans that were made on the way."""

    plan_at: Callable[[float], MotionPlan]
    load: Callable[[MotionPlan], float]
    best: MotionPlan | None = None
    best_s: float = float("inf")
    left: float = 0.0
    """[s] longest duration that was tried and left"""
    tried: dict[float, float] = field(default_factory=dict)
    """duration [s] → load; inf when there is no plan"""
    failure: UnsolvedError | InfeasibleMotion | None = None

    def attempt(self, seconds: float) -> bool:
        """Plan at one duration; whether it keeps the bounds."""
        try:
            plan = self.plan_at(seconds)
        except (UnsolvedError, InfeasibleMotion) as error:
            self.failure, self.tried[seconds] = error, float("inf")
            self.left = max(self.left, seconds)
            return False
        self.tried[seconds] = self.load(plan)
        if self.tried[seconds] > 1.0:
            self.left = max(self.left, seconds)
            return False
        if seconds < self.best_s:
            self.best, self.best_s = plan, seconds
        return True


def shortest(
    nominal_s: float, plan_at: Callable[[float], MotionPlan], load: Callable[[MotionPlan], float]
) -> MotionPlan:
    """The plan of the shortest duration whose `load` (largest ratio to a bound) is at most 1, by few solves.

    Speeds go about as one over the duration, so the load of a plan tells where to try next; what has no
    plan counts as overloaded.  Raises what the longest duration raised when none up to `LONGEST` times
    the nominal one has a plan, and `UnsolvedError` where a longer cycle does not lower the load: joint
    speeds fall with it, the torques of quasi-static steps do not.
    """
    search = _Search(plan_at, load)
    seconds, before = nominal_s, float("inf")
    while not search.attempt(seconds):
        over = search.tried[seconds]
        if seconds >= LONGEST * nominal_s or HELPS * before < over < float("inf"):
            raise _given_up(search, seconds)
        before = over
        seconds = min(LONGEST * nominal_s, seconds * min(2.0, over * 1.03 if over < float("inf") else 1.5))
    while len(search.tried) < SOLVES:
        if search.left >= search.best_s / (1.0 + RESOLUTION):
            break
        guess = search.best_s * max(0.5, 1.01 * search.tried[search.best_s])
        if not search.left:  # rows on joint speeds may keep the load where it is: go on until something gives
            search.attempt(min(guess, search.best_s / FARTHER))
            continue
        middle = (search.left * search.best_s) ** 0.5
        search.attempt(max(middle, min(guess, search.best_s / (1.0 + 0.5 * RESOLUTION))))
    assert search.best is not None
    return _told(search.best, search)


def _told(plan: MotionPlan, search: _Search) -> MotionPlan:
    tried = {f"{seconds:.3f}": round(load, 4) for seconds, load in sorted(search.tried.items())}
    report = plan.report
    return replace(plan, report=replace(report, details={**report.details, "durations_tried_s": tried}))


def _given_up(search: _Search, seconds: float) -> Exception:
    if search.failure is not None:
        return search.failure
    return UnsolvedError(
        f"no duration up to {seconds:.3g} s keeps joint speeds and torques below their bounds",
        {
            "families": ["duration"],
            "loads": {f"{s:.3g} s": round(load, 3) for s, load in sorted(search.tried.items())},
            "advice": "walk slower, take load off, or allow a higher speed_share or effort_share",
        },
    )
