"""Loads in the grasp of limbs: reaching, closing, lifting and putting down, and standing for it."""
