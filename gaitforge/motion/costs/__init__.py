r"""Cost families of the motion problem: Σ ∫ weight · residual² dt.

smoothness   joint accelerations and accelerations of the base
posture      joints near the nominal (locomotive limbs) or held posture
body         base height, roll, pitch, yaw and lateral drift
swing        foot heights near a smooth profile
sharing      CoP weights near equal shares

Every weight is per second of motion, so that it does not depend on the number of samples.
"""
