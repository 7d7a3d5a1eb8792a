"""Cases as data → jobs → rows → one table.

An `Experiment` lists jobs; `run_experiment` gives them to a few processes, writes each one's rows as soon as they are
measured, skips what an earlier run in the same folder has measured, and ends with ``results.json`` and a page.
"""
