"""After limbs have failed: the walk cut off, a halt, failed limbs off the ground, limp ones at rest."""
