"""Solvers of the motion problem: a class with `solve(problem) -> Solution`."""
