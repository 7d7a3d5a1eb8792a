"""Limbs that fail on the way: the walk cut off, the halt, limp limbs folded, and walking on with what is left."""
