"""Solvers of the motion problem: a class with `solve(problem, start) -> Solution`, see docs/motion.md."""
