"""Plans that ask too much of the motors are made again with bounds on what they may ask."""

from __future__ import annotations

from dataclasses import replace

from gaitforge.pipeline.search.tries import Result, Try, attempt, quick

SHARES = (1.2, 1.0)
"""Of the motors' efforts, by the plan's own distribution of forces, the gentler bound first: with 1.2 friction may
still spare them the rest, and what is bent less slips less (camera_leg with its package: 3.4 mm, with 1.0 5.4 mm)"""


def spared(one: Try, result: Result) -> Result:
    """What a try came to, or, where no contact forces let its motors hold it, the same with bounded efforts.

    Robots shift their weight and straighten their legs then.  Of plans that are all too much the one that asks for
    least is taken; `Result.what` says that efforts are bounded.
    """
    from gaitforge.motion.strain import bounded, strain_of

    if result.plan is None:
        return result
    strains = [(strain_of(one.robot, result.plan), result)]
    for share in SHARES:
        if strains[-1][0] <= 1.0:
            break
        named = {**one.named, "options": bounded(quick(one.named["options"]), share)}
        again = attempt(replace(one, what=f"{one.what}, at {share:g} of the motors' efforts", named=named))
        if again.plan is not None:
            strains.append((strain_of(one.robot, again.plan), again))
    return min(strains, key=lambda pair: pair[0])[1]
