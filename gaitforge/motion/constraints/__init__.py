r"""Constraint families of the motion problem: l ≤ c(x) ≤ u.

kinematics   FK(q, base) = e, CoM(q, base) = x
rolling      e_{j+1} − e_j = r (Δθ × ẑ) while a foot is in stance
balance      CoP = x − z / (g + z̈) ẍ = Σ w e, Σ w = 1
progress     the body advances by at least a share of the commanded travel (open segments)
joint_speed  |q_{j+1} − q_j| ≤ share · q̇_max dt
clearance    |p_a − p_b| ≥ r_a + r_b + margin for bodies of neighbouring limbs

Joint positions, the heights of feet and base, and tilt are bounds on variables (see `trajectory`).
"""
