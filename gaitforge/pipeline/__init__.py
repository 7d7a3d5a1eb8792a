"""Task + robot → gaits, transitions and stands → timeline → verdict → files.

``RobotModel, Task → [Gait(C, P), Transition(C, P), Stand, …] → Timeline → Verdict → run.mcap + summary.json``
"""
