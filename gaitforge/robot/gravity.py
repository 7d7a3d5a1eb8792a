"""The acceleration of free fall that plans, simulators and checks share."""

GRAVITY = 9.81
"""[m/s²] downwards"""
